//! Eigenvalues and singular values of small matrices.

use crate::Error;
use crate::number::Number;
use faer::{Mat, MatRef};
use num_complex::Complex64;

/// Eigenvalues and right vectors (columns) of a small matrix; exact conjugates where it is real.
pub(crate) fn small_eigen<T: Number>(
    matrix: MatRef<'_, T>,
) -> Result<(Vec<Complex64>, Mat<Complex64>), Error> {
    let order = matrix.nrows();
    let pairs = matrix.to_owned().eigen().map_err(|_| Error::NoConvergence { order })?;
    let values = pairs.S().column_vector();
    Ok(((0..order).map(|i| values[i]).collect(), pairs.U().to_owned()))
}

/// Smallest singular value of a small complex matrix; `None` if an entry is not finite.
pub(crate) fn smallest_singular_value(
    rows: usize,
    columns: usize,
    entry: impl Fn(usize, usize) -> Complex64,
) -> Option<f64> {
    let matrix = Mat::from_fn(rows, columns, entry);
    let values = matrix.singular_values().ok()?;
    values.last().copied()
}
