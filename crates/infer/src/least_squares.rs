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
    let of_cells = columns(tessellation, positions, terms, &std::sync::Arc::default());
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
    let of_frame = |frame: &Observation| {
        let columns = measured_columns(frame, &frame.tessellation, &frame.positions, terms);
        Ok(normal_equations(frame, &columns, space))
    };
    solve(space, frames.iter().map(of_frame))
}

/// The β within bounds that solves the normal equations of all frames together.
pub(crate) fn solve(
    space: &CoefficientSpace,
    frames: impl Iterator<Item = Result<(DMatrix<f64>, DVector<f64>), Error>>,
) -> Result<Vec<f64>, Error> {
    let p = space.dimension();
    let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for frame in frames {
        let (own, part) = frame?;
        normal += own;
        right += part;
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

/// XᵀX and Xᵀ(v − X c₀) of one frame.
pub(crate) fn normal_equations(
    frame: &Observation,
    columns: &Columns,
    space: &CoefficientSpace,
) -> (DMatrix<f64>, DVector<f64>) {
    let p = space.dimension();
    let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    let rows = free_rows(frame, columns, space);
    for (x, (_, rest)) in rows.iter().zip(residuals(frame, columns, space.origin().as_slice())) {
        normal += x.transpose() * x;
        right += x.transpose() * DVector::from_column_slice(rest.as_slice());
    }
    (normal, right)
}

/// What coefficients leave unexplained: datum and residual, for each target.
pub(crate) fn residuals(
    frame: &Observation,
    columns: &Columns,
    coefficients: &[f64],
) -> Vec<(usize, Vector<f64>)> {
    let mut rests: Vec<Vector<f64>> =
        frame.targets().map(|(datum, v)| v - predict(columns, coefficients, datum)).collect();
    frame.remove_background(&mut rests);
    frame.targets().map(|(datum, _)| datum).zip(rests).collect()
}

/// The same at the measured positions.
pub(crate) fn residuals_as_measured(
    frame: &Observation,
    terms: &[Term],
    coefficients: &[f64],
) -> Vec<(usize, Vector<f64>)> {
    let columns = measured_columns(frame, &frame.tessellation, &frame.positions, terms);
    residuals(frame, &columns, coefficients)
}

/// `X B` (2, p) for each target.
pub(crate) fn free_rows(
    frame: &Observation,
    columns: &Columns,
    space: &CoefficientSpace,
) -> Vec<DMatrix<f64>> {
    let fields: Vec<Vec<Vector<f64>>> = (0..space.dimension())
        .map(|k| {
            let along = space.basis().column(k);
            let mut field: Vec<Vector<f64>> =
                frame.targets().map(|(datum, _)| predict(columns, along.as_slice(), datum)).collect();
            frame.remove_background(&mut field);
            field
        })
        .collect();
    let count = fields.first().map_or_else(|| frame.targets().count(), Vec::len);
    (0..count).map(|row| DMatrix::from_fn(2, fields.len(), |axis, k| fields[k][row][axis])).collect()
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
