//! Inverse and determinant of dense positive definite matrices, by halves, so that the work is products of matrices.

use crate::Error;
use nalgebra::DMatrix;

/// Order up to which a matrix is not cut.
const SMALL: usize = 48;

/// The inverse of a symmetric positive definite matrix and its log determinant.
///
/// # Errors
/// [`Error::Degenerate`] if it is not positive definite.
pub(super) fn inverse(matrix: &DMatrix<f64>) -> Result<(DMatrix<f64>, f64), Error> {
    let n = matrix.nrows();
    if n <= SMALL {
        let factor = matrix.clone().cholesky().ok_or(Error::Degenerate)?;
        return Ok((factor.inverse(), factor.ln_determinant()));
    }
    let half = n / 2;
    let rest = n - half;
    let (first, first_determinant) = inverse(&matrix.view((0, 0), (half, half)).into_owned())?;
    let beside = matrix.view((0, half), (half, rest)).into_owned();
    let across = &first * &beside;
    let left = matrix.view((half, half), (rest, rest)) - beside.tr_mul(&across);
    let (last, last_determinant) = inverse(&left)?;
    let mixed = &across * &last;
    let mut whole = DMatrix::zeros(n, n);
    whole.view_mut((0, 0), (half, half)).copy_from(&(first + &mixed * across.transpose()));
    whole.view_mut((half, 0), (rest, half)).copy_from(&(-mixed.transpose()));
    whole.view_mut((0, half), (half, rest)).copy_from(&(-mixed));
    whole.view_mut((half, half), (rest, rest)).copy_from(&last);
    Ok((whole, first_determinant + last_determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_make_the_inverse_of_the_whole() {
        let n = 151;
        let root = DMatrix::from_fn(n, n, |i, j| ((3 * i + 7 * j * j) as f64).sin());
        let matrix = DMatrix::identity(n, n) + &root * root.transpose();
        let (found, log_determinant) = inverse(&matrix).unwrap();
        assert!((&matrix * &found - DMatrix::identity(n, n)).amax() < 1e-9);
        let expected = matrix.clone().cholesky().unwrap().ln_determinant();
        assert!((log_determinant - expected).abs() < 1e-9 * expected.abs());
        assert_eq!(inverse(&-matrix).unwrap_err(), Error::Degenerate);
    }
}
