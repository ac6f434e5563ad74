//! All eigenvalues of a dense matrix.

use crate::eigenpairs::Vectors;
use crate::{Eigenpairs, Error};
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, evd_cplx, evd_real, evd_scratch};
use faer::{MatMut, MatRef, Par};
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
