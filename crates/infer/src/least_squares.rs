//! The linear part: coefficients at fixed positions.

use crate::{CoefficientSpace, Error, Observation};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_model::{Term, columns};

/// The four fields that the coefficients multiply, at given positions.
pub(crate) type Columns = Vec<Vec<Vector<f64>>>;

/// Σ c_t X_t for one cell.
pub(crate) fn predict(columns: &Columns, coefficients: &[f64], cell: usize) -> Vector<f64> {
    columns.iter().zip(coefficients).fold(Vector::zeros(), |sum, (column, c)| sum + column[cell] * *c)
}

/// Least squares at the measured positions: the naive fit. Returns β.
pub(crate) fn fit(
    frames: &[Observation],
    terms: &[Term],
    space: &CoefficientSpace,
) -> Result<Vec<f64>, Error> {
    let p = space.dimension();
    let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for frame in frames {
        let columns = columns(&frame.tessellation, &frame.positions, terms);
        for (cell, target) in frame.targets() {
            let x = free_columns(&columns, space, cell);
            let rest = target - predict(&columns, space.origin().as_slice(), cell);
            normal += x.transpose() * &x;
            right += x.transpose() * DVector::from_column_slice(rest.as_slice());
        }
    }
    solve(normal, &right).map(|beta| beta.as_slice().to_vec())
}

/// What coefficients leave unexplained at the measured positions: cell and residual, for each target.
pub(crate) fn residuals(
    frame: &Observation,
    terms: &[Term],
    coefficients: &[f64],
) -> impl Iterator<Item = (usize, Vector<f64>)> {
    let columns = columns(&frame.tessellation, &frame.positions, terms);
    frame.targets().map(move |(cell, v)| (cell, v - predict(&columns, coefficients, cell)))
}

/// `X B` for one cell (2, p).
pub(crate) fn free_columns(columns: &Columns, space: &CoefficientSpace, cell: usize) -> DMatrix<f64> {
    DMatrix::from_fn(2, columns.len(), |axis, term| columns[term][cell][axis]) * space.basis()
}

/// Solves normal equations, after scaling each unknown by its own norm.
pub(crate) fn solve(normal: DMatrix<f64>, right: &DVector<f64>) -> Result<DVector<f64>, Error> {
    invert(normal).map(|inverse| inverse * right)
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
