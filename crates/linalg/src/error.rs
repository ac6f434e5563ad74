use thiserror::Error;

/// Why a matrix cannot be used or factorised.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The arrays of a sparse matrix do not fit together.
    #[error("the sparse matrix is malformed: {0}")]
    Malformed(&'static str),
    /// An entry is infinite or not a number.
    #[error("row {row} of the matrix has an entry that is not finite")]
    NotFinite {
        /// Row of numbers.
        row: usize,
    },
    /// A factorisation met a pivot that is not positive.
    #[error("the matrix is not positive definite")]
    NotPositiveDefinite,
    /// A factorisation met a pivot that is zero to rounding.
    #[error("the matrix is singular to rounding")]
    Singular,
    /// An iteration for eigenvalues did not end.
    #[error("the eigenvalues of a matrix of order {order} did not converge")]
    NoConvergence {
        /// Order of the matrix.
        order: usize,
    },
    /// Not enough memory for a factorisation.
    #[error("not enough memory to factorise a matrix of order {order}")]
    OutOfMemory {
        /// Order of the matrix.
        order: usize,
    },
}
