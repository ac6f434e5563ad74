//! The linear part: coefficients at fixed positions.

use crate::quadratic::Quadratic;
use crate::{CoefficientSpace, Error, Observation};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::{Term, columns};

/// The four fields that the coefficients multiply, at given positions: for cells or for grid points.
pub(crate) type Columns = Vec<Vec<Vector<f64>>>;

/// The columns as they are measured of cells at given positions.
pub(crate) fn measured_columns(
    frame: &Observation,
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    terms: &[Term],
) -> Columns {
    let of_cells = columns(tessellation, positions, terms);
    match frame.sampling(tessellation, positions) {
        None => of_cells,
        Some(sampling) => of_cells.iter().map(|column| sampling.average(column)).collect(),
    }
}

/// Σ c_t X_t at one place.
pub(crate) fn predict(columns: &Columns, coefficients: &[f64], datum: usize) -> Vector<f64> {
    columns.iter().zip(coefficients).fold(Vector::zeros(), |sum, (column, c)| sum + column[datum] * *c)
}

/// Least squares at the measured positions within bounds: the naive fit. Returns β.
pub(crate) fn fit(
    frames: &[Observation],
    terms: &[Term],
    space: &CoefficientSpace,
) -> Result<Vec<f64>, Error> {
    let p = space.dimension();
    let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for frame in frames {
        let columns = measured_columns(frame, &frame.tessellation, &frame.positions, terms);
        for (datum, target) in frame.targets() {
            let x = free_columns(&columns, space, datum);
            let rest = target - predict(&columns, space.origin().as_slice(), datum);
            normal += x.transpose() * &x;
            right += x.transpose() * DVector::from_column_slice(rest.as_slice());
        }
    }
    let free = invert(normal.clone())? * right;
    within_bounds(space, free, normal).map(|beta| beta.as_slice().to_vec())
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

/// What coefficients leave unexplained at the measured positions: datum and residual, for each target.
pub(crate) fn residuals(
    frame: &Observation,
    terms: &[Term],
    coefficients: &[f64],
) -> impl Iterator<Item = (usize, Vector<f64>)> {
    let columns = measured_columns(frame, &frame.tessellation, &frame.positions, terms);
    frame.targets().map(move |(datum, v)| (datum, v - predict(&columns, coefficients, datum)))
}

/// `X B` at one place (2, p).
pub(crate) fn free_columns(columns: &Columns, space: &CoefficientSpace, datum: usize) -> DMatrix<f64> {
    DMatrix::from_fn(2, columns.len(), |axis, term| columns[term][datum][axis]) * space.basis()
}

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
