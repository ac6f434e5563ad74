//! All eigenvalues of a dense matrix.

use crate::eigenpairs::Vectors;
use crate::{Eigenpairs, Error};
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, evd_cplx, evd_real, evd_scratch};
use faer::{Mat, MatMut, MatRef, Par};
use num_complex::Complex64;

/// Which vectors are computed with the eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// None.
    Values,
    /// The right ones.
    Right,
    /// The right and the left ones.
    RightAndLeft,
}

/// All eigenvalues of a real matrix of order `n`, given row by row, by the QR algorithm.
///
/// Time grows as n³ and memory is about 7 n² numbers with all vectors.
///
/// # Errors
/// [`Error::Malformed`] if the length is not n², [`Error::NotFinite`], [`Error::OutOfMemory`], [`Error::NoConvergence`].
///
/// ```
/// use voronudge_linalg::{Wanted, eigen};
/// // A quarter turn: ±i.
/// let pairs = eigen(&[0.0, -1.0, 1.0, 0.0], 2, Wanted::Right)?;
/// assert!((pairs.values[0].im - 1.0).abs() < 1e-15 && pairs.values[0].re.abs() < 1e-15);
/// # Ok::<(), voronudge_linalg::Error>(())
/// ```
pub fn eigen(matrix: &[f64], n: usize, wanted: Wanted) -> Result<Eigenpairs, Error> {
    if matrix.len() != n * n {
        return Err(Error::Malformed("a square matrix has as many columns as rows"));
    }
    if let Some(at) = matrix.iter().position(|entry| !entry.is_finite()) {
        return Err(Error::NotFinite { row: at / n });
    }
    let out_of_memory = || Error::OutOfMemory { order: n };
    let compute = |yes: bool| if yes { ComputeEigenvectors::Yes } else { ComputeEigenvectors::No };
    let (right, left) = (wanted != Wanted::Values, wanted == Wanted::RightAndLeft);
    let room = evd_scratch::<f64>(n, compute(left), compute(right), Par::Seq, Default::default());
    let mut scratch = MemBuffer::try_new(room).map_err(|_| out_of_memory())?;
    let (mut real, mut imaginary) = (vec![0.0; n], vec![0.0; n]);
    let columns = |yes: bool| -> Result<Vec<f64>, Error> {
        let mut columns = Vec::new();
        let length = if yes { n * n } else { 0 };
        columns.try_reserve_exact(length).map_err(|_| out_of_memory())?;
        columns.resize(length, 0.0);
        Ok(columns)
    };
    let (mut of_right, mut of_left) = (columns(right)?, columns(left)?);
    let view = |columns| MatMut::from_column_major_slice_mut(columns, n, n);
    evd_real(
        MatRef::from_row_major_slice(matrix, n, n),
        DiagMut::from_slice_mut(&mut real),
        DiagMut::from_slice_mut(&mut imaginary),
        left.then(|| view(&mut of_left)),
        right.then(|| view(&mut of_right)),
        Par::Seq,
        MemStack::new(&mut scratch),
        Default::default(),
    )
    .map_err(|_| Error::NoConvergence { order: n })?;
    let values: Vec<Complex64> =
        real.iter().zip(&imaginary).map(|(&re, &im)| Complex64::new(re, im)).collect();
    let place = |conjugate: f64| places(&values, conjugate);
    let vectors = |yes: bool, columns: Vec<f64>, sign: f64| {
        yes.then(|| Vectors { order: n, columns, place: place(sign) })
    };
    let mut pairs =
        Eigenpairs { right: vectors(right, of_right, 1.0), left: vectors(left, of_left, LEFT_SIGN), values };
    pairs.sort();
    Ok(pairs)
}

/// All eigenvalues of a complex matrix of order `n`, given row by row, with right vectors if these are wanted, by the QR algorithm.
///
/// # Errors
/// As [`eigen`].
///
/// ```
/// use voronudge_linalg::{Complex64, eigen_complex};
/// let pairs = eigen_complex(&[Complex64::I, Complex64::ONE, Complex64::ZERO, Complex64::ONE], 2, true)?;
/// assert!((pairs.values[0] - 1.0).norm() < 1e-15 && (pairs.values[1] - Complex64::I).norm() < 1e-15);
/// # Ok::<(), voronudge_linalg::Error>(())
/// ```
pub fn eigen_complex(matrix: &[Complex64], n: usize, vectors: bool) -> Result<Eigenpairs, Error> {
    if matrix.len() != n * n {
        return Err(Error::Malformed("a square matrix has as many columns as rows"));
    }
    if let Some(at) = matrix.iter().position(|entry| !entry.is_finite()) {
        return Err(Error::NotFinite { row: at / n });
    }
    let out_of_memory = || Error::OutOfMemory { order: n };
    let compute = if vectors { ComputeEigenvectors::Yes } else { ComputeEigenvectors::No };
    let room = evd_scratch::<Complex64>(n, ComputeEigenvectors::No, compute, Par::Seq, Default::default());
    let mut scratch = MemBuffer::try_new(room).map_err(|_| out_of_memory())?;
    let mut values = vec![Complex64::ZERO; n];
    let mut columns = vec![Complex64::ZERO; if vectors { n * n } else { 0 }];
    evd_cplx(
        MatRef::from_row_major_slice(matrix, n, n),
        DiagMut::from_slice_mut(&mut values),
        None,
        vectors.then(|| MatMut::from_column_major_slice_mut(&mut columns, n, n)),
        Par::Seq,
        MemStack::new(&mut scratch),
        Default::default(),
    )
    .map_err(|_| Error::NoConvergence { order: n })?;
    let right = vectors.then(|| {
        let mut right = Vectors { order: n, ..Vectors::default() };
        columns.chunks_exact(n.max(1)).for_each(|column| right.push(column));
        right
    });
    let mut pairs = Eigenpairs { values, right, left: None };
    pairs.sort();
    Ok(pairs)
}

/// Sign of the imaginary part of left vectors as the library packs them, for `yᴴ A = λ yᴴ`.
const LEFT_SIGN: f64 = 1.0;

/// Real eigenvalues have one column; of a pair the first has both, and the second the conjugate.
fn places(values: &[Complex64], sign: f64) -> Vec<(usize, Option<(usize, f64)>)> {
    let mut place = Vec::with_capacity(values.len());
    while place.len() < values.len() {
        let column = place.len();
        if values[column].im == 0.0 {
            place.push((column, None));
        } else {
            place.push((column, Some((column + 1, sign))));
            if column + 1 < values.len() {
                place.push((column, Some((column + 1, -sign))));
            }
        }
    }
    place
}

/// Eigenvalues and right vectors (columns) of a small complex matrix.
pub(crate) fn small_eigen(matrix: MatRef<'_, Complex64>) -> Result<(Vec<Complex64>, Mat<Complex64>), Error> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    /// Sizes below and above those at which the algorithm changes.
    #[test]
    fn pairs_satisfy_their_equations() {
        for side in [1, 2, 5, 9] {
            let matrix = sample::lattice(side, 0.7).to_dense();
            let n = 2 * side * side;
            let pairs = eigen(&matrix, n, Wanted::RightAndLeft).unwrap();
            let scale = matrix.iter().map(|x| x * x).sum::<f64>().sqrt();
            for (k, &value) in pairs.values.iter().enumerate() {
                let (x, y) = (pairs.right(k).unwrap(), pairs.left(k).unwrap());
                for row in 0..n {
                    let forward: Complex64 = (0..n).map(|j| x[j] * matrix[row * n + j]).sum();
                    assert!((forward - value * x[row]).norm() <= 1e-12 * scale, "{side}, {k} {value}");
                    let backward: Complex64 = (0..n).map(|i| y[i].conj() * matrix[i * n + row]).sum();
                    assert!((backward - value * y[row].conj()).norm() <= 1e-12 * scale, "{side}, {k}");
                }
                assert!(pairs.condition(k, 0.0).unwrap() > 1.0 - 1e-12);
            }
            assert!(pairs.values.windows(2).all(|pair| pair[0].re >= pair[1].re));
            let values = eigen(&matrix, n, Wanted::Values).unwrap();
            assert!(values.right(0).is_none());
            for (a, b) in values.values.iter().zip(&pairs.values) {
                assert!((a.re - b.re).abs() <= 1e-11 * scale);
            }
        }
    }

    #[test]
    fn eigenvalues_agree_with_another_implementation() {
        let matrix = sample::lattice(6, 0.3).to_dense();
        let other = nalgebra::DMatrix::from_row_slice(72, 72, &matrix).complex_eigenvalues();
        let found = eigen(&matrix, 72, Wanted::Values).unwrap().values;
        for value in other.iter() {
            let nearest = found.iter().map(|f| (f.re - value.re).hypot(f.im - value.im));
            assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-9);
        }
    }

    /// [[0, 1], [e, 0]] has the vectors (1, ±√e): condition (1 + e)/(2√e).
    #[test]
    fn the_condition_grows_where_vectors_coalesce() {
        let e = 1e-6;
        let pairs = eigen(&[0.0, 1.0, e, 0.0], 2, Wanted::RightAndLeft).unwrap();
        let expected = (1.0 + e) / (2.0 * e.sqrt());
        assert!((pairs.condition(0, 0.0).unwrap() / expected - 1.0).abs() < 1e-9);
        assert!((pairs.values[0].re - e.sqrt()).abs() < 1e-12);
    }

    /// diag(A, A) with A of two different values has every value twice, and the conditions of A.
    #[test]
    fn a_value_that_occurs_twice_has_the_condition_of_its_projector() {
        let matrix = [
            1.0, 7.0, 0.0, 0.0, //
            0.0, 2.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 7.0, //
            0.0, 0.0, 0.0, 2.0,
        ];
        let pairs = eigen(&matrix, 4, Wanted::RightAndLeft).unwrap();
        for k in 0..4 {
            assert!((pairs.condition(k, 1e-9).unwrap() - 50f64.sqrt()).abs() < 1e-10);
        }
    }

    /// A turned into Tᴴ A T, with the same values, and vectors that satisfy their equation.
    #[test]
    fn complex_matrices_have_the_values_of_the_real_ones_they_come_from() {
        let matrix = sample::lattice(4, 0.6).to_dense();
        let n = 32;
        let phase = |k: usize| Complex64::from_polar(1.0, (k * k) as f64);
        let turned: Vec<Complex64> =
            (0..n * n).map(|at| phase(at / n) * matrix[at] * phase(at % n).conj()).collect();
        let (expected, found) =
            (eigen(&matrix, n, Wanted::Values).unwrap(), eigen_complex(&turned, n, true).unwrap());
        for (k, value) in found.values.iter().enumerate() {
            let nearest = expected.values.iter().map(|other| (other - value).norm());
            assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-10);
            let x = found.right(k).unwrap();
            for row in 0..n {
                let product: Complex64 = turned[row * n..][..n].iter().zip(&x).map(|(a, x)| a * x).sum();
                assert!((product - value * x[row]).norm() < 1e-10);
            }
        }
        assert!(eigen_complex(&turned[1..], n, false).is_err());
    }

    #[test]
    fn impossible_matrices_are_refused() {
        assert!(matches!(eigen(&[1.0; 3], 2, Wanted::Values), Err(Error::Malformed(_))));
        let fault = eigen(&[1.0, 0.0, f64::NAN, 0.0], 2, Wanted::Values).unwrap_err();
        assert_eq!(fault, Error::NotFinite { row: 1 });
        assert!(eigen(&[], 0, Wanted::Right).unwrap().values.is_empty());
    }
}
