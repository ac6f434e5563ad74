//! The method of conjugate gradients (Hestenes and Stiefel 1952), right-hand sides side by side in lanes.

use super::{Held, Linearisation};
use crate::rows::Pair;
use voronudge_linalg::{Cholesky, Scratch};

/// Iterations after which factors are taken instead.
const MOST: usize = 400;

/// The iteration at which it is asked whether, going on as before, that would come to pass.
const ASKED: usize = 80;

/// A = JᵀJ + kHᵀH + λ and what stiffness there is beside, with its preconditioner M.
pub(super) struct Operator<'a> {
    pub frame: &'a Linearisation,
    pub spring: f64,
    pub held: &'a Held,
    /// λ; none if it is empty.
    pub damping: &'a [f64],
    pub alone: Cholesky,
}

/// Where iterations end.
pub(super) struct End<const L: usize> {
    /// Solutions.
    pub at: Vec<Pair<L>>,
    /// What they leave of the right-hand sides.
    pub left: Vec<Pair<L>>,
}

/// Memory for products.
struct Work<const L: usize> {
    of_rows: Vec<Pair<L>>,
    of_chains: Scratch,
}

impl Operator<'_> {
    /// Solutions for right-hand sides in lanes, up to what is left of them relative to what they are, both as M measures it; none if A is not positive
    /// definite or it takes too long.
    pub fn solve<const L: usize>(&self, mut left: Vec<Pair<L>>, tolerance: f64) -> Option<End<L>> {
        let mut work = Work { of_rows: Vec::new(), of_chains: Scratch::default() };
        let mut at = vec![[[0.0; L]; 2]; left.len()];
        let (mut along, mut next) = (at.clone(), left.clone());
        self.precondition(&mut next, &mut work);
        let mut direction = next.clone();
        let mut size = products(&left, &direction);
        let (first, enough) = (size, size.map(|size| tolerance.powi(2) * size));
        let by_then = tolerance.powf(2.0 * ASKED as f64 / MOST as f64);
        for iteration in 0..MOST {
            if iteration == ASKED && size.iter().zip(&first).any(|(size, first)| *size > by_then * first) {
                return None;
            }
            if size.iter().zip(&enough).all(|(size, enough)| size <= enough) {
                return Some(End { at, left });
            }
            self.apply(&direction, &mut along, &mut work);
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
            next.copy_from_slice(&left);
            self.precondition(&mut next, &mut work);
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
    fn apply<const L: usize>(&self, u: &[Pair<L>], to: &mut [Pair<L>], work: &mut Work<L>) {
        let Self { frame, spring, held, damping, .. } = self;
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
        held.stiffness.add_products(u, to);
        for (group, weight) in frame.groups(*spring, held) {
            group.add_products(weight, u, to, &mut work.of_rows);
        }
    }

    /// Solves for each chain by itself.
    fn precondition<const L: usize>(&self, sides: &mut [Pair<L>], work: &mut Work<L>) {
        self.alone.solve_side_by_side(sides.as_flattened_mut().as_flattened_mut(), &mut work.of_chains);
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
