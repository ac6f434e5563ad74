//! The normal equations of one frame, linearised about the current nudges and coefficients.
//!
//! With r = v − F, J = ∂F/∂ε, X = ∂F/∂β, the data linearised back to the measured positions are y = r + Jε:
//!
//! ```text
//! v ≈ F + X δβ + J δε       y ≈ X δβ + J (ε + δε)
//! ```
//!
//! There are data of two kinds: velocities, of weight one, and positions, of weight k, whose derivative by the nudges is
//! H. All that is quadratic in the data is a sum over both, `JᵀJ + k HᵀH` for one. Where a position is measured as it is,
//! H is the identity, and weight and nudge make a spring.
//!
//! Coordinates without a measured position (of cells that were not seen) have no row in H. They are unknowns of no
//! distribution, as coefficients are, but for a stiffness that keeps them near where they were put.

mod accuracy;
mod conjugate_gradients;
mod eliminated;
mod freedom;
mod iterated;
mod solved;

pub(crate) use accuracy::Accuracy;
pub(crate) use eliminated::Eliminated;
pub(crate) use solved::Weighting;

use crate::Error;
use crate::gram::of_all;
use crate::rows::{Group, Rows};
use crate::stiffness::Stiffness;
use crate::whitened::Whitened;
use nalgebra::{DMatrix, DVector};
use std::sync::OnceLock;
use voronudge_linalg::{DissectedCholesky, DissectedPattern, Dissections, SymmetricMatrix};
use voronudge_model::BlockMatrix;

/// The linearised problem of one frame.
#[derive(Debug)]
pub(crate) struct Linearisation {
    velocities: Group,
    positions: Group,
    /// Rows of what is known of unknowns beforehand, by kind.
    known: Vec<Group>,
    held: Held,
    /// The nudges ε at which it was linearised.
    nudges: Vec<f64>,
    /// As in [`Local`].
    places: Vec<Option<[f64; 3]>>,
    chains: Vec<u32>,
    dissections: Dissections,
    /// Once they are asked for.
    normals: OnceLock<Normals>,
    of_chains: OnceLock<Vec<SymmetricMatrix>>,
    /// Places that are held and not among the nudges.
    left_out: usize,
}

/// JᵀJ of each group, on the pattern of their sum, and the order in which that is eliminated.
#[derive(Debug)]
struct Normals {
    of_groups: Vec<SymmetricMatrix>,
    pattern: DissectedPattern,
}

/// What holds the unknowns beside the data.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    /// Of unknowns that no datum holds.
    pub stiffness: Stiffness,
    /// Weight of each kind of what is known of unknowns beforehand.
    pub weights: Vec<f64>,
}

/// What enters the linearisation of one frame.
pub(crate) struct Local<'a> {
    /// Velocities, weight one.
    pub velocities: Rows<'a>,
    /// Measured positions, weight k.
    pub positions: Rows<'a>,
    /// What is known of unknowns beforehand, each kind with its weight.
    pub known: Vec<(Rows<'a>, f64)>,
    /// ε, x and y of one place after the other.
    pub nudges: &'a [f64],
    /// What holds unknowns that no datum holds.
    pub stiffness: Stiffness,
    /// Number of free coefficients.
    pub free: usize,
    /// Where the coordinates belong, two after the other; those of `None` are coupled to all others.
    pub places: Vec<Option<[f64; 3]>>,
    /// Which blocks go together most, by a number of each: those of one cell at all times. Empty if unknowns are to be eliminated by factors,
    /// however many they are.
    pub chains: Vec<u32>,
    /// Orders of elimination that are known.
    pub dissections: &'a Dissections,
    /// Places that are measured but held, and not among the unknowns.
    pub left_out: usize,
}

impl Linearisation {
    pub fn new(local: Local<'_>) -> Self {
        let Local { velocities, positions, known, nudges, stiffness, free, places, .. } = local;
        let group = |rows: &Rows<'_>| Group::new(rows, nudges, free);
        let weights = known.iter().map(|(_, weight)| *weight).collect();
        Self {
            velocities: group(&velocities),
            positions: group(&positions),
            known: known.iter().map(|(rows, _)| group(rows)).collect(),
            held: Held { stiffness, weights },
            nudges: nudges.to_vec(),
            places,
            chains: local.chains,
            dissections: local.dissections.clone(),
            normals: OnceLock::new(),
            of_chains: OnceLock::new(),
            left_out: local.left_out,
        }
    }

    /// JᵀJ of each group, of pairs of blocks that go together.
    fn normals_among(
        &self,
        together: impl Fn(usize, usize) -> bool + Sync,
    ) -> Result<Vec<SymmetricMatrix>, Error> {
        let groups = [&self.velocities, &self.positions].into_iter().chain(&self.known);
        let matrices: Vec<&BlockMatrix> = groups.map(|group| &group.jacobian).collect();
        let links = self.held.stiffness.links().filter(|(later, earlier)| together(*later, *earlier));
        of_all(&matrices, links, self.order() / 2, &together)
    }

    fn normals(&self) -> Result<&Normals, Error> {
        if let Some(known) = self.normals.get() {
            return Ok(known);
        }
        let of_groups = self.normals_among(|_, _| true)?;
        let pattern = self.dissections.of(&of_groups[0], &self.places)?;
        Ok(self.normals.get_or_init(|| Normals { of_groups, pattern }))
    }

    /// Whether one factor at a time is enough.
    pub fn is_large(&self) -> Result<bool, Error> {
        Ok(self.normals()?.pattern.is_large())
    }

    /// Holds the unknowns otherwise; what is coupled must be the same.
    pub fn hold(&mut self, held: Held) {
        self.held = held;
    }

    /// All groups with their weights.
    fn groups<'a>(&'a self, spring: f64, held: &Held) -> impl Iterator<Item = (&'a Group, f64)> {
        let known = self.known.iter().zip(held.weights.iter().copied());
        [(&self.velocities, 1.0), (&self.positions, spring)].into_iter().chain(known)
    }

    /// Number of nudge components.
    pub fn order(&self) -> usize {
        self.nudges.len()
    }

    /// Number of nudge components, those that are held and left out included.
    pub fn components(&self) -> usize {
        self.order() + 2 * self.left_out
    }

    /// Number of measured coordinates.
    pub fn measured_components(&self) -> f64 {
        self.positions.components as f64
    }

    /// The trace of JᵀJ.
    pub fn trace(&self) -> f64 {
        self.velocities.diagonal().iter().sum()
    }

    /// The trace of HᵀH: the number of coordinates if all are measured alike. Those that are held count as one each.
    pub fn stiffness(&self) -> f64 {
        self.positions.diagonal().iter().sum::<f64>() + (2 * self.left_out) as f64
    }

    /// `Σ ‖∂v/∂r_j‖² / m_j` over measured coordinates, m_j the diagonal of HᵀH: what errors of position of unit variance make of
    /// the squared velocities.
    pub fn sensitivity(&self) -> f64 {
        let pairs = self.velocities.diagonal().into_iter().zip(self.positions.diagonal());
        pairs.filter(|(_, m)| *m > 0.0).map(|(slope, m)| slope / m).sum()
    }

    /// XᵀX of the velocities.
    pub fn free_normal(&self) -> &DMatrix<f64> {
        &self.velocities.free_normal
    }

    /// The factor of JᵀJ + k HᵀH and what stiffness there is beside.
    pub fn factor(&self, spring: f64) -> Result<DissectedCholesky, Error> {
        self.damped(spring, &[], &self.held)
    }

    fn damped(&self, spring: f64, damping: &[f64], held: &Held) -> Result<DissectedCholesky, Error> {
        let Normals { of_groups, pattern } = self.normals()?;
        let mut sum = self.summed(of_groups, spring, held)?;
        held.stiffness.add_to(&mut sum)?;
        sum.add_to_diagonal(damping.iter().copied());
        Ok(pattern.factor_raised(&mut sum)?)
    }

    /// The sum of one matrix for each group.
    fn summed(
        &self,
        normals: &[SymmetricMatrix],
        spring: f64,
        held: &Held,
    ) -> Result<SymmetricMatrix, Error> {
        let mut sum = normals[0].plus(spring, &normals[1])?;
        for (known, weight) in normals[2..].iter().zip(&held.weights) {
            sum = sum.plus(*weight, known)?;
        }
        Ok(sum)
    }

    /// `A⁻¹` for the two unknowns of a block, what coefficients do to these: `A⁻¹JᵀX` there (2 × p), with A = JᵀJ + kHᵀH and what stiffness there
    /// is beside, and the information on the coefficients that is left with A eliminated.
    pub fn of_block(&self, spring: f64, block: usize) -> Result<[DMatrix<f64>; 3], Error> {
        let factor = self.factor(spring)?;
        let (n, p) = (self.order(), self.velocities.free_gradient.len());
        let right = self.sum(spring, &self.held, |group| &group.mixed[..n * p]);
        let mut solved = right.clone();
        for axis in 0..2 {
            solved.extend((0..n).map(|i| f64::from(u8::from(i == 2 * block + axis))));
        }
        factor.solve(&mut solved);
        let at = |axis: usize, column: usize| solved[column * n + 2 * block + axis];
        let schur = self.schur(spring, &self.held, |a, b| product(&right, &solved, n, a, b));
        Ok([DMatrix::from_fn(2, 2, |i, j| at(i, p + j)), DMatrix::from_fn(2, p, at), schur])
    }

    /// What is left of the information on the coefficients where so much is taken off each entry.
    fn schur(&self, spring: f64, held: &Held, taken: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let p = self.velocities.free_gradient.len();
        let mut free = DMatrix::zeros(p, p);
        for (group, weight) in self.groups(spring, held) {
            free += &group.free_normal * weight;
        }
        DMatrix::from_fn(p, p, |a, b| free[(a, b)] - taken(a, b))
    }

    /// A vector of products, summed over all kinds of data.
    fn sum(&self, spring: f64, held: &Held, of: impl Fn(&Group) -> &[f64]) -> Vec<f64> {
        let pairs = of(&self.velocities).iter().zip(of(&self.positions));
        let mut sum: Vec<f64> =
            pairs.map(|(velocities, positions)| velocities + spring * positions).collect();
        for (known, weight) in self.known.iter().zip(&held.weights) {
            sum.iter_mut().zip(of(known)).for_each(|(sum, known)| *sum += weight * known);
        }
        sum
    }

    /// `JᵀX + kHᵀZ` (n × p, by columns), then `Jᵀy` with what positions add to it.
    pub fn mixed(&self, spring: f64) -> Vec<f64> {
        self.sum(spring, &self.held, |group| &group.mixed)
    }

    /// `Jᵀr + kHᵀs`: half the decrease of Φ with each nudge.
    pub fn pull(&self, spring: f64) -> Vec<f64> {
        let mut pull = self.sum(spring, &self.held, |group| &group.gradient);
        let held = self.held.stiffness.times(&self.nudges);
        pull.iter_mut().zip(held).for_each(|(pull, held)| *pull -= held);
        pull
    }

    /// Eliminates the nudges from a damped Gauss–Newton step
    ///
    /// ```text
    /// [ JᵀJ + kHᵀH + λ    JᵀX + kHᵀZ ] [δε]   [ Jᵀr + kHᵀs ]
    /// [ XᵀJ + kZᵀH        XᵀX + kZᵀZ ] [δβ] = [ Xᵀr + kZᵀs ]
    /// ```
    ///
    /// with the residuals s of the positions, their derivative Z by β and a damping λ of each nudge, if any.
    pub fn eliminate(&self, spring: f64, damping: &[f64], accuracy: Accuracy) -> Result<Eliminated, Error> {
        let sides = self.velocities.free_gradient.len();
        self.eliminate_by(self.are_many(sides).then_some(accuracy), spring, damping)
    }

    /// The same, perhaps by iteration first.
    pub fn eliminate_by(
        &self,
        iteration: Option<Accuracy>,
        spring: f64,
        damping: &[f64],
    ) -> Result<Eliminated, Error> {
        let held = &self.held;
        let (n, p) = (self.order(), self.velocities.free_gradient.len());
        let mut right = self.sum(spring, held, |group| &group.mixed[..n * p]);
        right.extend(self.pull(spring));
        let iterated = match iteration {
            Some(accuracy) => self.iterated(spring, damping, &right, accuracy)?,
            None => None,
        };
        let (solved, left) = match iterated {
            Some(found) => found,
            None => {
                let mut solved = right.clone();
                self.damped(spring, damping, held)?.solve(&mut solved);
                (solved, Vec::new())
            }
        };
        let dot = |a: usize, b: usize| eliminated(&right, &solved, &left, n, a, b);
        let mut free_gradient = DVector::zeros(p);
        for (group, weight) in self.groups(spring, held) {
            free_gradient += &group.free_gradient * weight;
        }
        let schur = self.schur(spring, held, dot);
        let gradient = DVector::from_fn(p, |a, _| free_gradient[a] - dot(a, p));
        Ok(Eliminated { order: n, gain: dot(p, p), schur, gradient, solved })
    }

    /// Generalised least squares about the measured positions, by `W⁻¹ = I − J (JᵀJ + kHᵀH)⁻¹ Jᵀ` and
    /// `det W = det(JᵀJ + kHᵀH) / kⁿ`, n the number of measured coordinates. Those that are not measured make W infinite along
    /// what they can do to the velocities: data are used up for them as for coefficients.
    pub fn whiten(&self, spring: f64) -> Result<Whitened, Error> {
        self.whiten_held(spring, &self.held)
    }

    /// The same without the determinant, for which a large frame needs no factor.
    pub fn whiten_data(&self, spring: f64) -> Result<Whitened, Error> {
        let mixed = self.mixed(spring);
        let (solved, left) = self.solutions_with_left(spring, &mixed)?;
        Ok(self.whitened(spring, &self.held, (&mixed, &solved, &left), f64::NAN))
    }

    /// The same with the unknowns held otherwise.
    pub fn whiten_held(&self, spring: f64, held: &Held) -> Result<Whitened, Error> {
        Ok(self.eliminate_data(spring, held)?.2)
    }

    /// The same with the factor of A = JᵀJ + kHᵀH and what stiffness there is beside, and `A⁻¹(JᵀX + kHᵀZ)` (n × p, by columns), then A⁻¹ times what
    /// data add.
    fn eliminate_data(
        &self,
        spring: f64,
        held: &Held,
    ) -> Result<(DissectedCholesky, Vec<f64>, Whitened), Error> {
        let factor = self.damped(spring, &[], held)?;
        let mixed = self.sum(spring, held, |group| &group.mixed);
        let mut solved = mixed.clone();
        factor.solve(&mut solved);
        let whitened = self.whitened(spring, held, (&mixed, &solved, &[]), factor.log_determinant());
        Ok((factor, solved, whitened))
    }

    /// From the products of data with all unknowns, `A⁻¹` of these, what they leave if anything, and log det A.
    fn whitened(
        &self,
        spring: f64,
        held: &Held,
        (mixed, solved, left): (&[f64], &[f64], &[f64]),
        log_determinant: f64,
    ) -> Whitened {
        let (n, p) = (self.order(), self.velocities.free_gradient.len());
        let dot = |a: usize, b: usize| eliminated(mixed, solved, left, n, a, b);
        let mut data = DVector::zeros(p);
        for (group, weight) in self.groups(spring, held) {
            data += &group.free_data * weight;
        }
        Whitened {
            free: self.schur(spring, held, dot),
            mixed: DVector::from_fn(p, |a, _| data[a] - dot(a, p)),
            data: self.groups(spring, held).map(|(group, weight)| weight * group.data).sum::<f64>()
                - dot(p, p),
            log_determinant: log_determinant - self.measured_components() * spring.ln(),
        }
    }
}

/// The product of column a of one matrix and column b of another, both of n rows.
fn product(left: &[f64], right: &[f64], n: usize, a: usize, b: usize) -> f64 {
    left[a * n..(a + 1) * n].iter().zip(&right[b * n..(b + 1) * n]).map(|(x, y)| x * y).sum()
}

/// `bᵀA⁻¹a` of two right-hand sides, of n numbers each, with their solutions and what these leave, if anything: that adds what makes the error of second
/// order.
fn eliminated(right: &[f64], solved: &[f64], left: &[f64], n: usize, a: usize, b: usize) -> f64 {
    let of_left = if left.is_empty() { 0.0 } else { product(left, solved, n, b, a) };
    product(right, solved, n, a, b) + of_left
}

#[cfg(test)]
mod tests;
