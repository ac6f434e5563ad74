//! What is solved with a normal matrix: its inverse, and the best point within bounds.

use crate::quadratic::Quadratic;
use crate::{CoefficientSpace, Error};
use nalgebra::{DMatrix, DVector};

/// The inverse of a normal matrix, refused if its columns are dependent to rounding.
pub(crate) fn invert(normal: DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let scale: Vec<f64> = normal.diagonal().iter().map(|d| d.sqrt()).collect();
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return Err(Error::Degenerate);
    }
    let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| normal[(i, j)] / (scale[i] * scale[j]));
    let eigenvalues = scaled.clone().symmetric_eigen().eigenvalues;
    if eigenvalues.min() < 1e-12 {
        return Err(Error::Degenerate);
    }
    let inverse = scaled.cholesky().ok_or(Error::Degenerate)?.inverse();
    Ok(DMatrix::from_fn(scale.len(), scale.len(), |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}

/// The point within the bounds of β where `(β − centre)ᵀ H (β − centre)` is least.
pub(crate) fn within_bounds(
    space: &CoefficientSpace,
    centre: DVector<f64>,
    hessian: DMatrix<f64>,
) -> Result<DVector<f64>, Error> {
    let bounds = space.half_spaces();
    if bounds.is_empty() {
        return Ok(centre);
    }
    let minimum = Quadratic::new(centre, &hessian)?.minimise(&bounds, None);
    minimum.map(|minimum| minimum.at).ok_or(Error::Constraint("no parameters lie within all bounds"))
}
