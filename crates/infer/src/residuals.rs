//! What a prediction leaves of measured velocities, and what coefficients do to it.

use crate::{CoefficientSpace, Observation};
use nalgebra::DMatrix;
use voronudge_geometry::Vector;

/// Fields for cells or for grid points, one for each coefficient.
pub(crate) type Columns = Vec<Vec<Vector<f64>>>;

/// Σ c_t X_t at one place.
pub(crate) fn combined(columns: &Columns, coefficients: &[f64], datum: usize) -> Vector<f64> {
    columns.iter().zip(coefficients).fold(Vector::zeros(), |sum, (column, c)| sum + column[datum] * *c)
}

/// What a prediction leaves unexplained: datum and residual, for each target.
pub(crate) fn residuals(frame: &Observation, predicted: &[Vector<f64>]) -> Vec<(usize, Vector<f64>)> {
    let mut rests: Vec<Vector<f64>> = frame.targets().map(|(datum, v)| v - predicted[datum]).collect();
    frame.remove_background(&mut rests);
    frame.targets().map(|(datum, _)| datum).zip(rests).collect()
}

/// `X B` (2, p) for each target.
pub(crate) fn free_rows(
    frame: &Observation,
    by_coefficient: &Columns,
    space: &CoefficientSpace,
) -> Vec<DMatrix<f64>> {
    let fields: Vec<Vec<Vector<f64>>> = (0..space.dimension())
        .map(|k| {
            let along = space.basis().column(k);
            let mut field: Vec<Vector<f64>> =
                frame.targets().map(|(datum, _)| combined(by_coefficient, along.as_slice(), datum)).collect();
            frame.remove_background(&mut field);
            field
        })
        .collect();
    let count = fields.first().map_or_else(|| frame.targets().count(), Vec::len);
    (0..count).map(|row| DMatrix::from_fn(2, fields.len(), |axis, k| fields[k][row][axis])).collect()
}
