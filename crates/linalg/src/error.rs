use thiserror::Error;

/// Why a matrix cannot be used or factorised.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The arrays of a sparse matrix do not fit together.
    #[error("the sparse matrix is malformed: {0}")]
    Malformed(&'static str),
    /// A factorisation met a pivot that is not positive.
    #[error("the matrix is not positive definite")]
    NotPositiveDefinite,
    /// Not enough memory for a factorisation.
    #[error("not enough memory to factorise a sparse matrix of order {order}")]
    OutOfMemory {
        /// Order of the matrix.
        order: usize,
    },
}
