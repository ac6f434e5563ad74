//! What holds unknowns beside the data: a quadratic form in them.
//!
//! ```text
//! S(u) = Σ_b a_b ‖u_b‖² − 2 Σ_(b, c) s_bc u_b·u_c
//! ```
//!
//! over blocks b of two unknowns. It is what the prior distribution of unknowns adds to the objective, in units of the variance of a velocity.

use crate::Error;
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
        if self.of_blocks.is_empty() {
            return vec![0.0; u.len()];
        }
        let mut product: Vec<f64> = u.iter().enumerate().map(|(k, u)| self.of_blocks[k / 2] * u).collect();
        for (later, earlier, coupling) in &self.couplings {
            for axis in 0..2 {
                let [one, other] = [later, earlier].map(|block| 2 * *block as usize + axis);
                product[one] -= coupling * u[other];
                product[other] -= coupling * u[one];
            }
        }
        product
    }

    /// The form's value.
    pub fn of(&self, u: &[f64]) -> f64 {
        self.times(u).iter().zip(u).map(|(s, u)| s * u).sum()
    }
}
