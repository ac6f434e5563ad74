//! A step of which the unknowns of single frames are eliminated.

use nalgebra::{DMatrix, DVector};

/// One frame's part of a step before the coefficients' part is known.
pub(crate) struct Eliminated {
    pub(super) order: usize,
    /// (JᵀJ + (k+λ)I)⁻¹ applied to JᵀX and to Jᵀr − kε.
    pub(super) solved: Vec<f64>,
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
