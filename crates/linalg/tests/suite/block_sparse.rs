//! Sparse matrices of blocks.

use crate::sample;
use voronudge_linalg::{BlockSparse, Complex64, Error};

#[test]
fn the_product_is_that_of_the_dense_matrix() {
    let matrix = sample::lattice(5, 0.4);
    let n = matrix.order();
    let (dense, other) = (matrix.to_dense(), matrix.transposed().to_dense());
    let x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let complex: Vec<Complex64> = x.iter().map(|&x| Complex64::new(x, -2.0 * x)).collect();
    let (mut y, mut z) = (vec![0.0; n], vec![Complex64::ZERO; n]);
    matrix.apply(&x, &mut y);
    matrix.apply(&complex, &mut z);
    for row in 0..n {
        let expected: f64 = (0..n).map(|column| dense[row * n + column] * x[column]).sum();
        assert!((y[row] - expected).abs() < 1e-12);
        assert!((z[row] - Complex64::new(expected, -2.0 * expected)).norm() < 1e-12);
        assert!((0..n).all(|column| dense[row * n + column] == other[column * n + row]));
        let sum: f64 = dense[row * n..][..n].iter().map(|entry| entry.abs()).sum();
        assert!(sum <= matrix.norm() * (1.0 + 1e-14));
    }
}

#[test]
fn malformed_arrays_are_refused() {
    assert!(BlockSparse::new(vec![], vec![], vec![]).is_err());
    assert!(BlockSparse::new(vec![0, 1], vec![1], vec![[0.0; 4]]).is_err());
    assert!(BlockSparse::new(vec![0, 2, 1], vec![0], vec![[0.0; 4]]).is_err());
    let fault = BlockSparse::new(vec![0, 0, 1], vec![0], vec![[0.0, f64::NAN, 0.0, 0.0]]);
    assert_eq!(fault.unwrap_err(), Error::NotFinite { row: 2 });
}
