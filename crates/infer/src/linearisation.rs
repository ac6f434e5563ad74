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

use crate::Error;
use crate::gram::{Chosen, grams};
use crate::rows::{Group, Rows};
use crate::stiffness::Stiffness;
use crate::whitened::Whitened;
use nalgebra::{DMatrix, DVector};
use voronudge_linalg::{Cholesky, CholeskyPattern, SymmetricMatrix};

/// The linearised problem of one frame.
#[derive(Debug)]
pub(crate) struct Linearisation {
    velocities: Group,
    positions: Group,
    /// Rows of what is known of unknowns beforehand.
    known: Option<Group>,
    held: Held,
    pattern: CholeskyPattern,
    /// The nudges ε at which it was linearised.
    nudges: Vec<f64>,
}

/// What holds the unknowns beside the data.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    /// Of unknowns that no datum holds.
    pub stiffness: Stiffness,
    /// Weight of what is known of unknowns beforehand.
    pub weight: f64,
}

/// What enters the linearisation of one frame.
pub(crate) struct Local<'a> {
    /// Velocities, weight one.
    pub velocities: Rows<'a>,
    /// Measured positions, weight k.
    pub positions: Rows<'a>,
    /// What is known of unknowns beforehand, and its weight.
    pub known: Option<(Rows<'a>, f64)>,
    /// ε, x and y of one place after the other.
    pub nudges: &'a [f64],
    /// What holds unknowns that no datum holds.
    pub stiffness: Stiffness,
    /// Number of free coefficients.
    pub free: usize,
    /// Where the coordinates belong, two after the other; those of `None` are coupled to all others.
    pub places: Vec<Option<[f64; 3]>>,
}

/// One frame's part of a step before the coefficients' part is known.
pub(crate) struct Eliminated {
    order: usize,
    /// (JᵀJ + (k+λ)I)⁻¹ applied to JᵀX and to Jᵀr − kε.
    solved: Vec<f64>,
    /// XᵀX − XᵀJ (JᵀJ + (k+λ)I)⁻¹ JᵀX
    pub schur: DMatrix<f64>,
    /// Its right-hand side.
    pub gradient: DVector<f64>,
    /// (Jᵀr − kε)ᵀ (JᵀJ + (k+λ)I)⁻¹ (Jᵀr − kε)
    pub gain: f64,
}

impl Eliminated {
    /// δε for given δβ.
    pub fn nudge_step(&self, free_step: &DVector<f64>) -> Vec<f64> {
        let n = self.order;
        let mut step = self.solved[free_step.len() * n..].to_vec();
        for (column, delta) in self.solved.chunks_exact(n).zip(free_step.iter()) {
            for (s, c) in step.iter_mut().zip(column) {
                *s -= delta * c;
            }
        }
        step
    }
}

impl Linearisation {
    pub fn new<'a>(local: &Local<'a>) -> Result<Self, Error> {
        let Local { velocities, positions, known, nudges, stiffness, free, places } = local;
        let chosen = |group: &Rows<'a>| Chosen {
            matrix: group.jacobian,
            rows: group.rows.iter().map(|row| row.0).collect(),
        };
        let (blocks, links) = (nudges.len() / 2, stiffness.links());
        let group = |rows: &Rows<'_>, normal: SymmetricMatrix| Group::new(rows, normal, nudges, *free);
        let weight = known.as_ref().map_or(0.0, |(_, weight)| *weight);
        let (of_velocities, of_positions, known) = match known {
            None => {
                let [of_velocities, of_positions] =
                    grams([chosen(velocities), chosen(positions)], links, blocks)?;
                (of_velocities, of_positions, None)
            }
            Some((rows, _)) => {
                let all = [chosen(velocities), chosen(positions), chosen(rows)];
                let [of_velocities, of_positions, of_known] = grams(all, links, blocks)?;
                (of_velocities, of_positions, Some(group(rows, of_known)))
            }
        };
        let pattern = CholeskyPattern::dissected(&of_velocities, places)?;
        Ok(Self {
            velocities: group(velocities, of_velocities),
            positions: group(positions, of_positions),
            held: Held { stiffness: stiffness.clone(), weight },
            known,
            pattern,
            nudges: nudges.to_vec(),
        })
    }

    /// Whether one factor at a time is enough.
    pub fn is_large(&self) -> bool {
        self.pattern.is_large()
    }

    /// Holds the unknowns otherwise; what is coupled must be the same.
    pub fn hold(&mut self, held: Held) {
        self.held = held;
    }

    /// All groups with their weights.
    fn groups<'a>(&'a self, spring: f64, held: &Held) -> impl Iterator<Item = (&'a Group, f64)> {
        let known = self.known.as_ref().map(|group| (group, held.weight));
        [(&self.velocities, 1.0), (&self.positions, spring)].into_iter().chain(known)
    }

    /// Number of nudge components.
    pub fn order(&self) -> usize {
        self.nudges.len()
    }

    /// The trace of JᵀJ.
    pub fn trace(&self) -> f64 {
        self.velocities.normal.diagonal().sum()
    }

    /// The trace of HᵀH: the number of coordinates if all are measured alike.
    pub fn stiffness(&self) -> f64 {
        self.positions.normal.diagonal().sum()
    }

    /// `Σ ‖∂v/∂r_j‖² / m_j` over measured coordinates, m_j the diagonal of HᵀH: what errors of position of unit variance make of
    /// the squared velocities.
    pub fn sensitivity(&self) -> f64 {
        let pairs = self.velocities.normal.diagonal().zip(self.positions.normal.diagonal());
        pairs.filter(|(_, m)| *m > 0.0).map(|(slope, m)| slope / m).sum()
    }

    /// XᵀX of the velocities.
    pub fn free_normal(&self) -> &DMatrix<f64> {
        &self.velocities.free_normal
    }

    /// The factor of JᵀJ + k HᵀH and what stiffness there is beside.
    pub fn factor(&self, spring: f64) -> Result<Cholesky, Error> {
        self.damped(spring, &[], &self.held)
    }

    fn damped(&self, spring: f64, damping: &[f64], held: &Held) -> Result<Cholesky, Error> {
        let mut sum: SymmetricMatrix = self.velocities.normal.plus(spring, &self.positions.normal)?;
        if let Some(known) = &self.known {
            sum = sum.plus(held.weight, &known.normal)?;
        }
        held.stiffness.add_to(&mut sum)?;
        sum.add_to_diagonal(damping.iter().copied());
        Ok(self.pattern.factor(&sum)?)
    }

    /// A vector of products, summed over all kinds of data.
    fn sum(&self, spring: f64, held: &Held, of: impl Fn(&Group) -> &[f64]) -> Vec<f64> {
        let pairs = of(&self.velocities).iter().zip(of(&self.positions));
        let mut sum: Vec<f64> =
            pairs.map(|(velocities, positions)| velocities + spring * positions).collect();
        if let Some(known) = &self.known {
            sum.iter_mut().zip(of(known)).for_each(|(sum, known)| *sum += held.weight * known);
        }
        sum
    }

    /// `JᵀX + kHᵀZ` (n × p, by columns), then `Jᵀy` with what positions add to it.
    pub fn mixed(&self, spring: f64) -> Vec<f64> {
        self.sum(spring, &self.held, |group| &group.mixed)
    }

    /// Eliminates the nudges from a damped Gauss–Newton step
    ///
    /// ```text
    /// [ JᵀJ + kHᵀH + λ    JᵀX + kHᵀZ ] [δε]   [ Jᵀr + kHᵀs ]
    /// [ XᵀJ + kZᵀH        XᵀX + kZᵀZ ] [δβ] = [ Xᵀr + kZᵀs ]
    /// ```
    ///
    /// with the residuals s of the positions, their derivative Z by β and a damping λ of each nudge, if any.
    pub fn eliminate(&self, spring: f64, damping: &[f64]) -> Result<Eliminated, Error> {
        let held = &self.held;
        let factor = self.damped(spring, damping, held)?;
        let (n, p) = (self.order(), self.velocities.free_gradient.len());
        let mut right = self.sum(spring, held, |group| &group.mixed[..n * p]);
        right.extend(self.sum(spring, held, |group| &group.gradient));
        for (g, pull) in right[n * p..].iter_mut().zip(held.stiffness.times(&self.nudges)) {
            *g -= pull;
        }
        let mut solved = right.clone();
        factor.solve(&mut solved);
        let dot = |a: usize, b: usize| product(&right, &solved, n, a, b);
        let free_normal = &self.velocities.free_normal + &self.positions.free_normal * spring;
        let free_gradient = &self.velocities.free_gradient + &self.positions.free_gradient * spring;
        let schur = DMatrix::from_fn(p, p, |a, b| free_normal[(a, b)] - dot(a, b));
        let gradient = DVector::from_fn(p, |a, _| free_gradient[a] - dot(a, p));
        Ok(Eliminated { order: n, gain: dot(p, p), schur, gradient, solved })
    }

    /// Generalised least squares about the measured positions, by `W⁻¹ = I − J (JᵀJ + kHᵀH)⁻¹ Jᵀ` and
    /// `det W = det(JᵀJ + kHᵀH) / kⁿ`, n the number of measured coordinates. Those that are not measured make W infinite along
    /// what they can do to the velocities: data are used up for them as for coefficients.
    pub fn whiten(&self, spring: f64) -> Result<Whitened, Error> {
        self.whiten_held(spring, &self.held)
    }

    /// The same with the unknowns held otherwise.
    pub fn whiten_held(&self, spring: f64, held: &Held) -> Result<Whitened, Error> {
        let factor = self.damped(spring, &[], held)?;
        let (n, p) = (self.order(), self.velocities.free_gradient.len());
        let mixed = self.sum(spring, held, |group| &group.mixed);
        let mut solved = mixed.clone();
        factor.solve(&mut solved);
        let dot = |a: usize, b: usize| product(&mixed, &solved, n, a, b);
        let (velocities, positions) = (&self.velocities, &self.positions);
        let free = &velocities.free_normal + &positions.free_normal * spring;
        let data = &velocities.free_data + &positions.free_data * spring;
        Ok(Whitened {
            free: DMatrix::from_fn(p, p, |a, b| free[(a, b)] - dot(a, b)),
            mixed: DVector::from_fn(p, |a, _| data[a] - dot(a, p)),
            data: self.groups(spring, held).map(|(group, weight)| weight * group.data).sum::<f64>()
                - dot(p, p),
            log_determinant: factor.log_determinant() - positions.components as f64 * spring.ln(),
        })
    }

    /// Directions of the nudges that the data determine, `df = n − k tr (JᵀJ + kHᵀH)⁻¹HᵀH`, which is n less the derivative of
    /// `log det(JᵀJ + kHᵀH)` with respect to log k.
    pub fn degrees_of_freedom(&self, spring: f64) -> Result<f64, Error> {
        let above = self.factor(spring * STEP.exp())?.log_determinant();
        let below = self.factor(spring * (-STEP).exp())?.log_determinant();
        let n = self.order() as f64;
        Ok((n - (above - below) / (2.0 * STEP)).clamp(0.0, n))
    }
}

/// Step in log k of the derivative of the log determinant; its square is the relative error.
const STEP: f64 = 2e-4;

/// The product of column a of one matrix and column b of another, both of n rows.
fn product(left: &[f64], right: &[f64], n: usize, a: usize, b: usize) -> f64 {
    left[a * n..(a + 1) * n].iter().zip(&right[b * n..(b + 1) * n]).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Observation;
    use crate::position_rows::PositionRows;
    use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Tessellation, Vector};
    use voronudge_model::{Model, Parameters, jacobian};

    /// The eliminated step solves the full dense system. One position is measured better than the others, one not at all.
    #[test]
    fn the_step_agrees_with_the_dense_normal_equations() {
        let positions: Vec<Vector<f64>> = (0..25)
            .map(|i| {
                let x = f64::from(i);
                Vector::new(f64::from(i % 5) + 0.3 * x.sin(), f64::from(i / 5) + 0.3 * (2.0 * x).cos())
            })
            .collect();
        let domain = Domain::Periodic(PeriodicBox::new([5.0, 5.0]).unwrap());
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let model = Model::chiral_voronoi(&Parameters { chirality: 0.7, ..Parameters::default() });
        let jacobian = jacobian(&tessellation, &positions, &model);
        let (cells, free, spring, damping) = (25, 2, 0.3, 0.05);
        // Some velocities are missing.
        let rows: Vec<(usize, Vector<f64>, DMatrix<f64>)> = (0..cells)
            .filter(|cell| cell % 4 != 0)
            .map(|cell| {
                let x = cell as f64;
                (
                    cell,
                    Vector::new(x.sin(), x.cos()),
                    DMatrix::from_fn(2, free, |i, j| (x + i as f64 + 3.0 * j as f64).cos()),
                )
            })
            .collect();
        let nudges: Vec<f64> = (0..cells).flat_map(|i| [0.01 * i as f64, -0.02]).collect();
        let (unseen, floor) = (7, 0.04);
        // Two places, far from each other.
        let (coupled, coupling) = ((21, 3), 0.1);
        let stiffness =
            |cell: usize| [1.0_f64, 4.0, 0.0][usize::from(cell == 3) + 2 * usize::from(cell == unseen)];
        let errors: Vec<f64> = (0..cells).map(|cell| stiffness(cell).powf(-0.5)).collect();
        let frame = Observation::new(0, positions.clone(), vec![None; cells], domain, FieldOfView::default())
            .unwrap();
        let frame = frame.with_position_errors(&errors);
        let positions = PositionRows::new(&frame, &tessellation, &positions, &nudges, free, None);
        let local = Local {
            velocities: Rows { jacobian: &jacobian, rows: &rows },
            positions: positions.rows(),
            known: None,
            nudges: &nudges,
            stiffness: Stiffness {
                of_blocks: (0..cells).map(|cell| if cell == unseen { floor } else { 0.0 }).collect(),
                couplings: vec![(coupled.0 as u32, coupled.1 as u32, coupling)],
            },
            free,
            places: (0..cells).map(|i| Some([(i % 5) as f64, (i / 5) as f64, 0.0])).collect(),
        };
        let springs = |spring: f64| {
            let of = |i: usize| if i / 2 == unseen { floor } else { spring * stiffness(i / 2) };
            let mut held = DMatrix::from_diagonal(&DVector::from_fn(2 * cells, |i, _| of(i)));
            for axis in 0..2 {
                let (later, earlier) = (2 * coupled.0 + axis, 2 * coupled.1 + axis);
                held[(later, earlier)] -= coupling;
                held[(earlier, later)] -= coupling;
            }
            held
        };
        let linearised = Linearisation::new(&local).unwrap();
        let dense = DMatrix::from_row_slice(2 * cells, 2 * cells, &jacobian.to_dense());
        let n = 2 * cells;
        let (mut full, mut right) =
            (DMatrix::<f64>::zeros(n + free, n + free), DVector::<f64>::zeros(n + free));
        for (cell, residual, x) in &rows {
            let mut wide = DMatrix::zeros(2, n + free);
            wide.view_mut((0, 0), (2, n)).copy_from(&dense.rows(2 * cell, 2));
            wide.view_mut((0, n), (2, free)).copy_from(x);
            full += wide.transpose() * &wide;
            right += wide.transpose() * residual;
        }
        let held = springs(spring);
        let mut corner = full.view_mut((0, 0), (n, n));
        corner += &held + DMatrix::identity(n, n) * damping;
        let mut pulled = right.rows_mut(0, n);
        pulled -= &held * DVector::from_column_slice(&nudges);
        let expected = full.lu().solve(&right).unwrap();
        let eliminated = linearised.eliminate(spring, &vec![damping; n]).unwrap();
        let free_step = eliminated.schur.clone().lu().solve(&eliminated.gradient).unwrap();
        let step = eliminated.nudge_step(&free_step);
        let scale = expected.amax();
        assert!((0..free).all(|i| (free_step[i] - expected[n + i]).abs() < 1e-10 * scale));
        assert!((0..n).all(|i| (step[i] - expected[i]).abs() < 1e-10 * scale));
        // What is left of n by the springs: n − k tr (JᵀJ + kHᵀH + floor)⁻¹ HᵀH, dense.
        let mut seen = DMatrix::zeros(2 * rows.len(), n);
        for (k, (cell, ..)) in rows.iter().enumerate() {
            seen.view_mut((2 * k, 0), (2, n)).copy_from(&dense.rows(2 * cell, 2));
        }
        let inverse = (seen.transpose() * &seen + &held).try_inverse().unwrap();
        let taken: f64 =
            (0..n).filter(|i| i / 2 != unseen).map(|i| spring * stiffness(i / 2) * inverse[(i, i)]).sum();
        let df = linearised.degrees_of_freedom(spring).unwrap();
        assert!((df - (n as f64 - taken)).abs() < 1e-6, "{df} {}", n as f64 - taken);
        // W = I + J D⁻¹ Jᵀ, dense, with the stiffness D of the springs.
        let m = 2 * rows.len();
        let of_springs = held.determinant().ln();
        let compliance = held.try_inverse().unwrap();
        let w = DMatrix::identity(m, m) + &seen * compliance * seen.transpose();
        let inverse = w.clone().try_inverse().unwrap();
        let x = DMatrix::from_fn(m, free, |i, j| rows[i / 2].2[(i % 2, j)]);
        let residual = DVector::from_fn(m, |i, _| rows[i / 2].1[i % 2]);
        let y = residual + &seen * DVector::from_column_slice(&nudges);
        let whitened = linearised.whiten(spring).unwrap();
        assert!((whitened.free - x.transpose() * &inverse * &x).amax() < 1e-9);
        assert!((whitened.mixed - x.transpose() * &inverse * &y).amax() < 1e-9);
        assert!((whitened.data - (y.transpose() * &inverse * &y)[0]).abs() < 1e-9);
        let determinant = w.cholesky().unwrap().l().diagonal().iter().map(|d| 2.0 * d.ln()).sum::<f64>();
        // det (JᵀJ + D) = det W det D, without the k of each measured coordinate.
        let constant = of_springs - (2 * (cells - 1)) as f64 * spring.ln();
        assert!((whitened.log_determinant - determinant - constant).abs() < 1e-9);
        assert!((linearised.stiffness() - (46.0 + 8.0)).abs() < 1e-12);
    }
}
