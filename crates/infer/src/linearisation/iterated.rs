//! Unknowns eliminated by conjugate gradients, where they are many and factors dear.
//!
//! The unknowns of a movie are coupled to those of the same cell at other times and to those of cells two rings away: factors of their matrix A are
//! dense, while J is not. The preconditioner is A without what couples different chains, the unknowns of one cell each: positive definite if A is.
//!
//! Right-hand sides go together by lanes, for which J is read once.

use super::Linearisation;
use crate::Error;
use crate::rows::{Pair, from_lanes, to_lanes};
use rayon::prelude::*;
use voronudge_linalg::Cholesky;

/// Unknowns below which factors are cheaper, and right-hand sides above which they are.
const MANY: usize = 6000;
const FEW_SIDES: usize = 16;

/// Right-hand sides that go together.
const LANES: usize = 4;

/// Size of what is left of a right-hand side, relative to it, both as the preconditioner measures them. What is computed from solutions errs by the square.
const TOLERANCE: f64 = 1e-6;

/// Iterations after which factors are taken instead.
const MOST: usize = 400;

/// Solutions, one after the other, and what they leave of the right-hand sides.
pub(super) type Iterated = (Vec<f64>, Vec<f64>);

impl Linearisation {
    /// Whether the unknowns are so many that they are eliminated by iteration.
    pub(super) fn are_many(&self) -> bool {
        !self.chains.is_empty() && self.order() >= MANY && self.velocities.free_gradient.len() < FEW_SIDES
    }

    /// `A⁻¹` of some right-hand sides, one after the other, with A = JᵀJ + kHᵀH + λ and what stiffness there is beside. None if the iteration does not come
    /// to an end.
    pub(super) fn iterated(
        &self,
        spring: f64,
        damping: &[f64],
        right: &[f64],
    ) -> Result<Option<Iterated>, Error> {
        let Some(alone) = self.chains_alone(spring, damping)? else { return Ok(None) };
        let operator = Operator { frame: self, spring, damping, alone };
        let n = self.order().max(1);
        let of_some = |some: &[f64]| match some.len() / n {
            1 => operator.solve::<1>(some),
            _ => operator.solve::<LANES>(some),
        };
        let Some(found) = right.par_chunks(LANES * n).map(of_some).collect::<Option<Vec<Iterated>>>() else {
            return Ok(None);
        };
        let (solved, left): (Vec<Vec<f64>>, Vec<Vec<f64>>) = found.into_iter().unzip();
        Ok(Some((solved.concat(), left.concat())))
    }

    /// The factor of each chain by itself; none if one has none.
    fn chains_alone(&self, spring: f64, damping: &[f64]) -> Result<Option<Cholesky>, Error> {
        let together = |one: usize, other: usize| self.chains[one] == self.chains[other];
        let normals = match self.of_chains.get() {
            Some(known) => known,
            None => {
                let found = self.normals_among(together)?;
                self.of_chains.get_or_init(|| found)
            }
        };
        let mut sum = self.summed(normals, spring, &self.held)?;
        self.held.stiffness.among(together).add_to(&mut sum)?;
        sum.add_to_diagonal(damping.iter().copied());
        Ok(Cholesky::new(&sum).ok())
    }
}

/// A, with its preconditioner.
struct Operator<'a> {
    frame: &'a Linearisation,
    spring: f64,
    damping: &'a [f64],
    alone: Cholesky,
}

impl Operator<'_> {
    /// Solutions for as many right-hand sides as there are lanes, or fewer; none if A is not positive definite or it takes too long.
    fn solve<const L: usize>(&self, right: &[f64]) -> Option<Iterated> {
        let n = self.frame.order();
        let mut left: Vec<Pair<L>> = to_lanes(right, n);
        let mut at = vec![[[0.0; L]; 2]; left.len()];
        let mut along = at.clone();
        let mut direction = self.preconditioned(&left);
        let mut size = products(&left, &direction);
        let enough = size.map(|size| TOLERANCE.powi(2) * size);
        for _ in 0..MOST {
            if size.iter().zip(&enough).all(|(size, enough)| size <= enough) {
                let sides = right.len() / n.max(1);
                return Some((from_lanes(&at, sides), from_lanes(&left, sides)));
            }
            self.apply(&direction, &mut along);
            let curvature = products(&direction, &along);
            let mut step = [0.0; L];
            for lane in (0..L).filter(|lane| size[*lane] > enough[*lane]) {
                if curvature[lane].is_nan() || curvature[lane] <= 0.0 {
                    return None;
                }
                step[lane] = size[lane] / curvature[lane];
            }
            add(&mut at, step, &direction);
            add(&mut left, step.map(|step| -step), &along);
            let next = self.preconditioned(&left);
            let before = std::mem::replace(&mut size, products(&left, &next));
            let mut share = [0.0; L];
            for lane in (0..L).filter(|lane| before[*lane] > 0.0) {
                share[lane] = size[lane] / before[lane];
            }
            for (direction, next) in direction.iter_mut().zip(&next) {
                for axis in 0..2 {
                    for lane in 0..L {
                        direction[axis][lane] = next[axis][lane] + share[lane] * direction[axis][lane];
                    }
                }
            }
        }
        None
    }

    /// A times vectors.
    fn apply<const L: usize>(&self, u: &[Pair<L>], to: &mut [Pair<L>]) {
        let Self { frame, spring, damping, .. } = self;
        to.fill([[0.0; L]; 2]);
        if !damping.is_empty() {
            for ((to, u), damping) in to.iter_mut().zip(u).zip(damping.chunks_exact(2)) {
                for axis in 0..2 {
                    for lane in 0..L {
                        to[axis][lane] = damping[axis] * u[axis][lane];
                    }
                }
            }
        }
        frame.held.stiffness.add_products(u, to);
        for (group, weight) in frame.groups(*spring, &frame.held) {
            group.add_products(weight, u, to);
        }
    }

    fn preconditioned<const L: usize>(&self, left: &[Pair<L>]) -> Vec<Pair<L>> {
        let mut columns = from_lanes(left, L);
        self.alone.solve(&mut columns);
        to_lanes(&columns, 2 * left.len())
    }
}

/// The product of vectors in each lane.
fn products<const L: usize>(one: &[Pair<L>], other: &[Pair<L>]) -> [f64; L] {
    let mut sums = [0.0; L];
    for (one, other) in one.iter().flatten().zip(other.iter().flatten()) {
        for lane in 0..L {
            sums[lane] += one[lane] * other[lane];
        }
    }
    sums
}

fn add<const L: usize>(to: &mut [Pair<L>], factors: [f64; L], other: &[Pair<L>]) {
    for (to, other) in to.iter_mut().flatten().zip(other.iter().flatten()) {
        for lane in 0..L {
            to[lane] += factors[lane] * other[lane];
        }
    }
}
