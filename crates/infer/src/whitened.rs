//! Generalised least squares: the whitened data of a linearised problem, and what the best coefficients leave.

use crate::Error;
use crate::normal_matrix::invert;
use nalgebra::{DMatrix, DVector};

/// `W⁻¹ = (I + JJᵀ/k)⁻¹` between y and X, and its determinant.
#[derive(Debug, Clone)]
pub(crate) struct Whitened {
    /// XᵀW⁻¹X
    pub free: DMatrix<f64>,
    /// XᵀW⁻¹y
    pub mixed: DVector<f64>,
    /// yᵀW⁻¹y
    pub data: f64,
    /// log det W
    pub log_determinant: f64,
}

/// What generalised least squares leaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leftover {
    /// yᵀPy
    pub misfit: f64,
    /// log det W + log det XᵀW⁻¹X
    pub log_determinant: f64,
}

impl Whitened {
    /// The sum over frames, for p coefficients.
    pub fn sum<'a>(parts: impl IntoIterator<Item = &'a Self>, p: usize) -> Self {
        let nothing =
            Self { free: DMatrix::zeros(p, p), mixed: DVector::zeros(p), data: 0.0, log_determinant: 0.0 };
        parts.into_iter().fold(nothing, |mut sum, part| {
            sum.free += &part.free;
            sum.mixed += &part.mixed;
            sum.data += part.data;
            sum.log_determinant += part.log_determinant;
            sum
        })
    }

    /// What the best coefficients leave.
    ///
    /// # Errors
    /// [`Error::Degenerate`] if the data do not determine them.
    pub fn restricted(&self) -> Result<Leftover, Error> {
        let inverse = invert(self.free.clone())?;
        let factor = self.free.clone().cholesky().ok_or(Error::Degenerate)?;
        let information = 2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let misfit = self.data - (self.mixed.transpose() * inverse * &self.mixed).sum();
        Ok(Leftover { misfit, log_determinant: self.log_determinant + information })
    }
}
