//! Solving linear systems with a sparse matrix of 2 × 2 blocks, shifted.

use crate::sparse_lu::{Side, SparseLu};
use crate::{BlockSparse, Complex64, Error};

/// `A − σ 1` for a sparse matrix of 2 × 2 blocks, factorised to solve systems with it. It need not be symmetric.
///
/// ```
/// use voronudge_linalg::{BlockSparse, LinearSystem};
/// // [[2, 1], [-1, 2]] x = [4, 3]
/// let matrix = BlockSparse::new(vec![0, 1], vec![0], vec![[2.0, 1.0, -1.0, 2.0]])?;
/// let mut x = [4.0, 3.0];
/// LinearSystem::new(&matrix, 0.0, &[[0.0, 0.0]])?.solve(&mut x);
/// assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15);
/// # Ok::<(), voronudge_linalg::Error>(())
/// ```
pub struct LinearSystem {
    factors: SparseLu<f64>,
}

impl LinearSystem {
    /// Factorises `A − σ 1` for a shift σ; `places` (one for each block row) are where the unknowns are in the plane. They only decide the order of
    /// elimination.
    ///
    /// # Errors
    /// [`Error::Malformed`] unless there is a place for each block row; the error of a singular matrix.
    pub fn new(matrix: &BlockSparse, shift: f64, places: &[[f64; 2]]) -> Result<Self, Error> {
        Ok(Self { factors: SparseLu::new(matrix, Complex64::new(shift, 0.0), places)? })
    }

    /// Replaces a right-hand side, in the order of the matrix, by the solution.
    pub fn solve(&self, right_hand_side: &mut [f64]) {
        self.factors.solve(Side::AsGiven, right_hand_side);
    }
}
