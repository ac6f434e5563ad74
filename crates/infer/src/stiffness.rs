//! What holds unknowns beside the data: a quadratic form in them.
//!
//! ```text
//! S(u) = Σ_b a_b ‖u_b‖² − 2 Σ_(b, c) s_bc u_b·u_c
//! ```
//!
//! over blocks b of two unknowns. It is what the prior distribution of unknowns adds to the objective, in units of the variance of a velocity.

use crate::Error;
use crate::rows::{Pair, from_lanes, to_lanes};
use voronudge_linalg::SymmetricMatrix;

/// A quadratic form, the same for both unknowns of a block.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Stiffness {
    /// a of each block; empty if nothing is held.
    pub of_blocks: Vec<f64>,
    /// Two blocks, the later one first, and what couples them.
    pub couplings: Vec<(u32, u32, f64)>,
}

impl Stiffness {
    /// Blocks held each by itself.
    pub fn of_blocks(of_blocks: impl Iterator<Item = f64>) -> Self {
        Self { of_blocks: of_blocks.collect(), couplings: Vec::new() }
    }

    /// The blocks that are coupled, the later one first.
    pub fn links(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.couplings.iter().map(|(later, earlier, _)| (*later as usize, *earlier as usize))
    }

    /// The form without what couples blocks that do not go together.
    pub fn among(&self, together: impl Fn(usize, usize) -> bool) -> Self {
        let kept = |link: &&(u32, u32, f64)| together(link.0 as usize, link.1 as usize);
        Self {
            of_blocks: self.of_blocks.clone(),
            couplings: self.couplings.iter().filter(kept).copied().collect(),
        }
    }

    /// Adds the form to a matrix that has entries for it.
    pub fn add_to(&self, matrix: &mut SymmetricMatrix) -> Result<(), Error> {
        matrix.add_to_diagonal(self.of_blocks.iter().flat_map(|own| [*own; 2]));
        for (later, earlier, coupling) in &self.couplings {
            for axis in 0..2 {
                matrix.add(2 * *later as usize + axis, 2 * *earlier as usize + axis, -coupling)?;
            }
        }
        Ok(())
    }

    /// The form's matrix times a vector.
    pub fn times(&self, u: &[f64]) -> Vec<f64> {
        let mut product = vec![[[0.0]; 2]; u.len() / 2];
        self.add_products(&to_lanes::<1>(u, u.len()), &mut product);
        from_lanes(&product, 1)
    }

    /// Adds the form's matrix times vectors, side by side in lanes.
    pub fn add_products<const L: usize>(&self, u: &[Pair<L>], to: &mut [Pair<L>]) {
        for ((to, u), own) in to.iter_mut().zip(u).zip(&self.of_blocks) {
            for (to, u) in to.iter_mut().flatten().zip(u.iter().flatten()) {
                *to += own * u;
            }
        }
        for (later, earlier, coupling) in &self.couplings {
            for (one, other) in [(later, earlier), (earlier, later)] {
                let to = to[*one as usize].iter_mut().flatten();
                to.zip(u[*other as usize].iter().flatten()).for_each(|(to, u)| *to -= coupling * u);
            }
        }
    }

    /// The form's value.
    pub fn of(&self, u: &[f64]) -> f64 {
        self.times(u).iter().zip(u).map(|(s, u)| s * u).sum()
    }
}
