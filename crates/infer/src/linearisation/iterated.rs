//! Unknowns eliminated by conjugate gradients, where they are many and factors dear.
//!
//! The unknowns of a movie are coupled to those of the same cell at other times and to those of cells two rings away: factors of their matrix A are
//! dense, while J is not. The preconditioner is A without what couples different chains, the unknowns of one cell each: positive definite if A is.
//!
//! Right-hand sides go together by lanes, for which J is read once.

use super::accuracy::Accuracy;
use super::conjugate_gradients::Operator;
use super::{Held, Linearisation};
use crate::Error;
use crate::rows::{from_lanes, to_lanes};
use rayon::prelude::*;
use voronudge_linalg::Cholesky;

/// Unknowns below which factors are cheaper, and right-hand sides above which they are.
const MANY: usize = 6000;
const FEW_SIDES: usize = 16;

/// Unknowns above which a factor is dear whatever the number of right-hand sides.
const FACTORED: usize = 16_000;

/// Right-hand sides that go together.
pub(super) const LANES: usize = 4;

/// Solutions, one after the other, and what they leave of the right-hand sides.
pub(super) type Iterated = (Vec<f64>, Vec<f64>);

impl Linearisation {
    /// Whether the unknowns are so many that they are eliminated from so many right-hand sides by iteration.
    pub(super) fn are_many(&self, sides: usize) -> bool {
        !self.chains.is_empty() && self.order() >= MANY && sides < FEW_SIDES
    }

    /// `A⁻¹` of some right-hand sides, one after the other, with A = JᵀJ + kHᵀH + λ and what stiffness there is beside. None if the iteration does not come
    /// to an end.
    pub(super) fn iterated(
        &self,
        spring: f64,
        damping: &[f64],
        right: &[f64],
        accuracy: Accuracy,
    ) -> Result<Option<Iterated>, Error> {
        let Some(operator) = self.operator(spring, &self.held, damping)? else { return Ok(None) };
        let tolerance = self.tolerance(accuracy);
        let n = self.order().max(1);
        let of_some = |some: &[f64]| match some.len() / n {
            1 => lanes::<1>(&operator, some, tolerance),
            _ => lanes::<LANES>(&operator, some, tolerance),
        };
        let Some(found) = right.par_chunks(LANES * n).map(of_some).collect::<Option<Vec<Iterated>>>() else {
            return Ok(None);
        };
        let (solved, left): (Vec<Vec<f64>>, Vec<Vec<f64>>) = found.into_iter().unzip();
        Ok(Some((solved.concat(), left.concat())))
    }

    /// `A⁻¹` times some vectors, one after the other, with A = JᵀJ + kHᵀH and what stiffness there is beside.
    pub fn solutions(&self, spring: f64, right: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.solutions_with_left(spring, right)?.0)
    }

    /// The same, with what they leave of the vectors where they come from iteration.
    pub(super) fn solutions_with_left(&self, spring: f64, right: &[f64]) -> Result<Iterated, Error> {
        let sides = right.len() / self.order().max(1);
        if (self.are_many(sides) || self.is_past_factors())
            && let Some(found) = self.iterated(spring, &[], right, Accuracy::OfResults)?
        {
            return Ok(found);
        }
        let mut solved = right.to_vec();
        self.factor(spring)?.solve(&mut solved);
        Ok((solved, Vec::new()))
    }

    /// Whether a frame is so large that factors are not taken where there is another way.
    pub(super) fn is_past_factors(&self) -> bool {
        !self.chains.is_empty() && self.order() > FACTORED
    }

    /// Size of what is left of a right-hand side, relative to it, both as the preconditioner measures them. What is computed from solutions errs by the
    /// square.
    fn tolerance(&self, accuracy: Accuracy) -> f64 {
        match accuracy {
            Accuracy::OfSteps if self.is_past_factors() && self.is_frame_by_itself() => 1e-2,
            Accuracy::OfSteps => 1e-3,
            Accuracy::OfResults => 1e-6,
        }
    }

    /// Whether no cell is there at several times.
    fn is_frame_by_itself(&self) -> bool {
        self.chains.iter().zip(0..).all(|(chain, own)| *chain == own)
    }

    /// A, with the factor of each chain by itself; none if one has none.
    pub(super) fn operator<'a>(
        &'a self,
        spring: f64,
        held: &'a Held,
        damping: &'a [f64],
    ) -> Result<Option<Operator<'a>>, Error> {
        let together = |one: usize, other: usize| self.chains[one] == self.chains[other];
        let normals = match self.of_chains.get() {
            Some(known) => known,
            None => {
                let found = self.normals_among(together)?;
                self.of_chains.get_or_init(|| found)
            }
        };
        let mut sum = self.summed(normals, spring, held)?;
        held.stiffness.among(together).add_to(&mut sum)?;
        sum.add_to_diagonal(damping.iter().copied());
        let alone = Cholesky::new(&sum).ok();
        Ok(alone.map(|alone| Operator { frame: self, spring, held, damping, alone }))
    }
}

/// Solutions for as many right-hand sides as there are lanes, or fewer.
fn lanes<const L: usize>(operator: &Operator<'_>, right: &[f64], tolerance: f64) -> Option<Iterated> {
    let n = operator.frame.order();
    let sides = right.len() / n.max(1);
    let end = operator.solve::<L>(to_lanes(right, n), tolerance)?;
    Some((from_lanes(&end.at, sides), from_lanes(&end.left, sides)))
}
