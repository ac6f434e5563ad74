//! Factors, solutions and eigenvalues against other ways to the same numbers.
#![allow(clippy::unwrap_used)]

mod block_sparse;
mod cholesky;
mod dense_eigen;
mod dissected_cholesky;
mod dissection;
mod partial_eigen;
mod sample;
mod separator;
mod sparse_lu;
mod symmetric_matrix;
