//! Sparse and dense linear algebra behind a small interface: the only place that knows the library that does it.
//!
//! ```
//! use voronudge_linalg::{Cholesky, SymmetricMatrix};
//!
//! // [[4, 1], [1, 3]] x = [1, 2], given by its lower triangle in compressed columns.
//! let matrix = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![4.0, 1.0, 3.0])?;
//! let mut x = [1.0, 2.0];
//! Cholesky::new(&matrix)?.solve(&mut x);
//! assert!((x[0] - 1.0 / 11.0).abs() < 1e-15 && (x[1] - 7.0 / 11.0).abs() < 1e-15);
//! # Ok::<(), voronudge_linalg::Error>(())
//! ```

mod arnoldi;
mod block_sparse;
mod cholesky;
mod dense_eigen;
mod dissected_cholesky;
mod dissection;
mod dissections;
mod eigenpairs;
mod error;
mod front_factor;
mod fronts;
mod graph;
mod linear_system;
mod number;
mod partial_eigen;
mod room;
mod selected_inverse;
mod separator;
mod small_matrix;
mod sparse_lu;
mod symmetric_matrix;

pub use block_sparse::BlockSparse;
pub use cholesky::{Cholesky, FactorForm, Scratch};
pub use dense_eigen::{Wanted, eigen, eigen_complex};
pub use dissected_cholesky::{DissectedCholesky, DissectedPattern};
pub use dissections::Dissections;
pub use eigenpairs::Eigenpairs;
pub use error::Error;
pub use linear_system::LinearSystem;
pub use num_complex::Complex64;
pub use partial_eigen::{PartialEigenpairs, Progress, RESIDUAL_LIMIT, nearest, rightmost};
pub use selected_inverse::SelectedInverse;
pub use symmetric_matrix::SymmetricMatrix;
