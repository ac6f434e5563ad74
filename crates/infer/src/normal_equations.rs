//! The linearised problem of all frames: the nudges eliminated, the few coefficients found within their bounds.

use crate::linearisation::{Accuracy, Eliminated, Held, Linearisation};
use crate::normal_matrix::{invert, within_bounds};
use crate::quadratic::HalfSpace;
use crate::{CoefficientSpace, Error, NoiseLevels};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Share of the diagonal of XᵀX that rounding leaves where data say nothing of a coefficient.
const ROUNDING: f64 = 1e-9;

/// Distance from a bound, in standard errors, at which it counts as active.
const ACTIVE: f64 = 1e-6;

/// Points that are looked at together: each takes the memory of a factor.
const TOGETHER: usize = 4;

/// The same of points each of which takes a linearised problem of its own.
pub(crate) const LINEARISED_TOGETHER: usize = 2;

/// The linearised problem of all frames.
#[derive(Debug)]
pub(crate) struct NormalEquations {
    pub frames: Vec<Linearisation>,
    priors: Priors,
    spring: f64,
    /// σ_v
    velocity: f64,
    free: DVector<f64>,
    space: CoefficientSpace,
    /// Half the decrease with β of what −2 log L has beside Φ/σ_v².
    tilt: DVector<f64>,
}

/// A step and the decrease of Φ that it promises.
pub(crate) struct Step {
    /// δβ, then δε frame by frame.
    pub step: Vec<f64>,
    pub promised: f64,
}

/// The linearised problem in β alone.
pub(crate) struct Reduced {
    /// The information on β, in units of 1/σ_v².
    pub information: DMatrix<f64>,
    /// Half the decrease of Φ with β.
    pub gradient: DVector<f64>,
}

impl Reduced {
    /// The problem in the first coefficients alone, the last ones, as many as given, eliminated.
    ///
    /// # Errors
    /// [`Error::Degenerate`] if those are not determined.
    pub fn without_last(&self, count: usize) -> Result<Self, Error> {
        let own = self.gradient.len() - count;
        let mixed = self.information.view((0, own), (own, count));
        let inverse = invert(self.information.view((own, own), (count, count)).into_owned())?;
        Ok(Self {
            information: self.information.view((0, 0), (own, own)) - mixed * &inverse * mixed.transpose(),
            gradient: self.gradient.rows(0, own) - mixed * inverse * self.gradient.rows(own, count),
        })
    }
}

/// The problem in β alone, from its parts with the nudges eliminated.
fn reduce(parts: &[Eliminated], priors: Priors) -> Reduced {
    let (mut information, mut gradient) = (priors.normal, priors.gradient);
    for part in parts {
        information += &part.schur;
        gradient += &part.gradient;
    }
    Reduced { information, gradient }
}

/// The penalty of the priors, linearised about the present coefficients.
#[derive(Debug, Clone)]
struct Priors {
    /// Half their second derivative with respect to β.
    normal: DMatrix<f64>,
    /// Half their decrease with β.
    gradient: DVector<f64>,
}

impl Priors {
    fn new(space: &CoefficientSpace, velocity: f64, free: &[f64]) -> Self {
        let p = space.dimension();
        let mut sum = Self { normal: DMatrix::zeros(p, p), gradient: DVector::zeros(p) };
        if space.priors().is_empty() {
            return sum;
        }
        let c = space.coefficients(free);
        for (quantity, prior) in space.priors() {
            let scale = velocity / prior.standard_deviation;
            let rest = (prior.mean - quantity.of(c.as_slice())) * scale;
            let gradient = space.in_free(&quantity.gradient(c.as_slice())) * scale;
            sum.normal += &gradient * gradient.transpose();
            sum.gradient += gradient * rest;
        }
        sum
    }

    /// With half the decrease with β of what −2 log L has beside Φ/σ_v².
    fn tilted(mut self, tilt: &DVector<f64>, velocity: f64) -> Self {
        self.gradient += tilt * velocity.powi(2);
        self
    }
}

impl NormalEquations {
    /// The problem about the coefficients `free` at some noise levels, from its independent parts.
    pub fn new(
        space: &CoefficientSpace,
        levels: NoiseLevels,
        free: &[f64],
        frames: Vec<Linearisation>,
    ) -> Self {
        Self {
            frames,
            priors: Priors::new(space, levels.velocity, free),
            spring: levels.spring(),
            velocity: levels.velocity,
            free: DVector::from_column_slice(free),
            space: space.clone(),
            tilt: DVector::zeros(free.len()),
        }
    }

    /// The same with half the decrease with β of what −2 log L has beside Φ/σ_v².
    pub fn tilted(mut self, tilt: DVector<f64>) -> Self {
        self.priors = self.priors.tilted(&tilt, self.velocity);
        Self { tilt, ..self }
    }

    /// The same problem at other noise levels.
    pub fn at_levels(self, levels: NoiseLevels) -> Self {
        Self::new(&self.space, levels, self.free.as_slice(), self.frames).tilted(self.tilt)
    }

    /// The reduced problem at other noise levels.
    pub fn reduced_at(&self, levels: NoiseLevels) -> Result<Reduced, Error> {
        let priors = Priors::new(&self.space, levels.velocity, self.free.as_slice());
        Ok(reduce(&self.eliminated(levels.spring())?, priors.tilted(&self.tilt, levels.velocity)))
    }

    /// Something of each of some points for which the unknowns are eliminated, in parallel as far as memory should go.
    pub fn each<P: Sync, T: Send>(
        &self,
        points: &[P],
        of: impl Fn(&P) -> Result<T, Error> + Sync,
    ) -> Result<Vec<T>, Error> {
        self.each_of(TOGETHER, points, of)
    }

    /// The same, at most so many at a time.
    pub fn each_of<P: Sync, T: Send>(
        &self,
        mut together: usize,
        points: &[P],
        of: impl Fn(&P) -> Result<T, Error> + Sync,
    ) -> Result<Vec<T>, Error> {
        for frame in &self.frames {
            together = if frame.is_large()? { 1 } else { together };
        }
        let mut all = Vec::with_capacity(points.len());
        for some in points.chunks(together) {
            all.extend(some.par_iter().map(&of).collect::<Result<Vec<T>, Error>>()?);
        }
        Ok(all)
    }

    /// Holds the unknowns of each part otherwise.
    pub fn hold(&mut self, held: &Held) {
        self.frames.iter_mut().for_each(|frame| frame.hold(held.clone()));
    }

    /// The information of the priors, in units of 1/σ_v².
    pub fn of_priors(&self) -> &DMatrix<f64> {
        &self.priors.normal
    }

    /// Number of free coefficients.
    pub fn dimension(&self) -> usize {
        self.free.len()
    }

    /// Number of places: pairs of nudges.
    pub fn places(&self) -> usize {
        self.frames.iter().map(Linearisation::order).sum::<usize>() / 2
    }

    /// A damped Gauss–Newton step within the bounds. Damping is in units of the mean diagonal of JᵀJ + kHᵀH for nudges, and for
    /// coefficients of the diagonal of what nudges that follow them leave of their information. That can be a thousandth of XᵀX: in
    /// units of this, coefficients crawl along the valley of the nudges. Some places may be held harder, each by a damping of its own; none if there are none.
    pub fn step(&self, damping: f64, held: &[f64]) -> Result<Step, Error> {
        let p = self.free.len();
        self.stepped(damping, held, &DMatrix::zeros(p, p), Accuracy::OfSteps)
    }

    /// A step to be kept, with coefficients that are also known, to be what they are, with some information in units of 1/σ_v².
    pub fn step_near(&self, damping: f64, held: &[f64], known: &DMatrix<f64>) -> Result<Step, Error> {
        self.stepped(damping, held, known, Accuracy::OfResults)
    }

    fn stepped(
        &self,
        damping: f64,
        held: &[f64],
        known: &DMatrix<f64>,
        accuracy: Accuracy,
    ) -> Result<Step, Error> {
        let count: usize = self.frames.iter().map(Linearisation::components).sum();
        let diagonal = |frame: &Linearisation| frame.trace() + self.spring * frame.stiffness();
        let unit = self.frames.iter().map(diagonal).sum::<f64>() / count as f64;
        let shift = damping * unit;
        let mut first = 0;
        let shifts: Vec<Vec<f64>> = self
            .frames
            .iter()
            .map(|frame| {
                let own = first..first + frame.order();
                first = own.end;
                own.map(|i| shift + unit * held.get(i / 2).unwrap_or(&0.0)).collect()
            })
            .collect();
        let eliminated: Vec<_> = self
            .frames
            .par_iter()
            .zip(&shifts)
            .map(|(frame, shifts)| frame.eliminate(self.spring, shifts, accuracy))
            .collect::<Result<_, _>>()?;
        let p = self.free.len();
        let (mut schur, mut gradient) = (&self.priors.normal + known, self.priors.gradient.clone());
        let mut rounding = DVector::zeros(p);
        for (frame, part) in self.frames.iter().zip(&eliminated) {
            schur += &part.schur;
            gradient += &part.gradient;
            rounding += frame.free_normal().diagonal() * ROUNDING;
        }
        let damped = schur.diagonal().sup(&rounding) * damping;
        let hessian = &schur + DMatrix::from_diagonal(&damped);
        let free_step = if p == 0 {
            gradient.clone()
        } else {
            let newton = hessian.clone().cholesky().ok_or(Error::Degenerate)?.solve(&gradient);
            within_bounds(&self.space, &self.free + newton, hessian.clone())? - &self.free
        };
        // The damped model of Φ decreases by 2gᵀδ − δᵀ(H + λD)δ; Φ itself by λ δᵀDδ more.
        let mut promised = 2.0 * gradient.dot(&free_step)
            - (free_step.transpose() * hessian * &free_step).sum()
            + free_step.component_mul(&free_step).dot(&damped);
        let mut step = free_step.as_slice().to_vec();
        for (part, shifts) in eliminated.iter().zip(&shifts) {
            let own = part.nudge_step(&free_step);
            promised += part.gain + own.iter().zip(shifts).map(|(e, shift)| shift * e * e).sum::<f64>();
            step.extend(own);
        }
        Ok(Step { step, promised })
    }

    /// The problem in β alone, and the derivatives of all unknowns by β where the nudges follow it.
    pub fn ridge(&self) -> Result<(Reduced, DMatrix<f64>), Error> {
        let parts = self.eliminated(self.spring)?;
        let p = self.free.len();
        let at = |free: &DVector<f64>| {
            let nudges = parts.iter().flat_map(|part| part.nudge_step(free));
            DVector::from_iterator(p + 2 * self.places(), free.iter().copied().chain(nudges))
        };
        let still = at(&DVector::zeros(p));
        let columns: Vec<DVector<f64>> = (0..p)
            .map(|k| at(&DVector::from_fn(p, |row, _| f64::from(u8::from(row == k)))) - &still)
            .collect();
        Ok((reduce(&parts, self.priors.clone()), DMatrix::from_columns(&columns)))
    }

    /// log det of the second derivative of Φ with respect to the nudges.
    pub fn log_determinant(&self) -> Result<f64, Error> {
        self.frames.iter().map(|frame| Ok(frame.factor(self.spring)?.log_determinant())).sum()
    }

    /// Covariance of the two unknowns of a block where there is one part, all others free, in units of σ_v².
    pub fn covariance_of(&self, block: usize) -> Result<DMatrix<f64>, Error> {
        let Some(frame) = self.frames.first() else { return Err(Error::Degenerate) };
        let [own, by_coefficients, information] = frame.of_block(self.spring, block)?;
        let covariance = invert(&self.priors.normal + information)?;
        Ok(own + &by_coefficients * covariance * by_coefficients.transpose())
    }

    /// Half the decrease of Φ with the two unknowns of a block where there is one part, all others held.
    pub fn pull_on(&self, block: usize) -> Result<DVector<f64>, Error> {
        let Some(frame) = self.frames.first() else { return Err(Error::Degenerate) };
        Ok(DVector::from_column_slice(&frame.pull(self.spring)[2 * block..2 * block + 2]))
    }

    /// The problem in β alone, with the nudges eliminated and priors included.
    pub fn reduced(&self) -> Result<Reduced, Error> {
        Ok(reduce(&self.eliminated(self.spring)?, self.priors.clone()))
    }

    /// Each part with its nudges eliminated.
    fn eliminated(&self, spring: f64) -> Result<Vec<Eliminated>, Error> {
        self.frames.iter().map(|frame| frame.eliminate(spring, &[], Accuracy::OfResults)).collect()
    }

    /// The β at which the linearised problem would be least without the bounds that hold it back: where its constrained
    /// minimum is the present β. Without such bounds it is the present β itself.
    pub fn unbounded(&self, reduced: &Reduced) -> Result<DVector<f64>, Error> {
        let inverse = invert(reduced.information.clone())?;
        let is_active = |half: &HalfSpace| {
            let variance = (half.normal.transpose() * &inverse * &half.normal).sum();
            let distance = half.normal.dot(&self.free) - half.bound;
            distance.abs() <= ACTIVE * variance.sqrt() * self.velocity
        };
        let active: Vec<DVector<f64>> =
            self.space.half_spaces().into_iter().filter(is_active).map(|half| half.normal).collect();
        if active.is_empty() {
            return Ok(self.free.clone());
        }
        // How hard the data pull against each bound; what pulls away from one is a residue of the optimiser.
        let normals = DMatrix::from_columns(&active);
        let against = invert(normals.transpose() * &inverse * &normals)?
            * normals.transpose()
            * &inverse
            * &reduced.gradient;
        let pull = normals * against.map(|pull| pull.min(0.0));
        Ok(&self.free + inverse * pull)
    }

    /// `‖∂v/∂r‖²` over the velocities used and the positions measured, each in units of its error.
    pub fn sensitivity(&self) -> f64 {
        self.frames.iter().map(Linearisation::sensitivity).sum()
    }

    /// Directions of the nudges that the data determine.
    pub fn degrees_of_freedom(&self) -> Result<f64, Error> {
        self.frames.iter().map(|frame| frame.degrees_of_freedom(self.spring)).sum()
    }
}
