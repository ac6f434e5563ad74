//! Solving linear systems with a sparse matrix of 2 × 2 blocks, shifted.

use crate::front_factor::Side;
use crate::number::Number;
use crate::sparse_lu::SparseLu;
use crate::{BlockSparse, Complex64, Error};

/// Real and complex numbers.
#[expect(private_bounds, reason = "of the library that factorises")]
pub trait SystemNumber: Number {}
impl SystemNumber for f64 {}
impl SystemNumber for Complex64 {}

/// `A − σ 1` for a sparse matrix of 2 × 2 blocks, factorised to solve systems with it. It need not be symmetric.
///
/// ```
/// use voronudge_linalg::{BlockSparse, Complex64, LinearSystem};
/// // [[2, 1], [-1, 2]] x = [4, 3]
/// let matrix = BlockSparse::new(vec![0, 1], vec![0], vec![[2.0, 1.0, -1.0, 2.0]])?;
/// let mut x = [4.0, 3.0];
/// LinearSystem::new(&matrix, 0.0, &[[0.0, 0.0]])?.solve(&mut x);
/// assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15);
///
/// // [[2 − i, 1], [-1, 2 − i]] x = [4, 3]
/// let mut x = [4.0, 3.0].map(Complex64::from);
/// LinearSystem::new(&matrix, Complex64::I, &[[0.0, 0.0]])?.solve(&mut x);
/// assert!(((2.0 - Complex64::I) * x[0] + x[1] - 4.0).norm() < 1e-15);
/// # Ok::<(), voronudge_linalg::Error>(())
/// ```
pub struct LinearSystem<T: SystemNumber> {
    factors: SparseLu<T>,
}

impl<T: SystemNumber + Into<Complex64>> LinearSystem<T> {
    /// Factorises `A − σ 1` for a real or complex shift σ; `places` (one for each block row) are where the unknowns are in the plane. They only decide the order of
    /// elimination.
    ///
    /// # Errors
    /// [`Error::Malformed`] unless there is a place for each block row; the error of a singular matrix.
    pub fn new(matrix: &BlockSparse, shift: T, places: &[[f64; 2]]) -> Result<Self, Error> {
        Ok(Self { factors: SparseLu::new(matrix, shift.into(), places)? })
    }

    /// Replaces a right-hand side, in the order of the matrix, by the solution.
    pub fn solve(&self, right_hand_side: &mut [T]) {
        self.factors.solve(Side::AsGiven, right_hand_side);
    }
}
