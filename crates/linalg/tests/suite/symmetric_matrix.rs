//! Symmetric matrices in compressed columns.

use voronudge_linalg::SymmetricMatrix;

#[test]
fn malformed_arrays_are_refused() {
    assert!(SymmetricMatrix::new(vec![0, 2, 3], vec![1, 0, 1], vec![1.0; 3]).is_err());
    assert!(SymmetricMatrix::new(vec![0, 2], vec![0, 1], vec![1.0; 2]).is_err());
    assert!(SymmetricMatrix::new(vec![], vec![], vec![]).is_err());
}

#[test]
fn sums_need_one_pattern() {
    let one = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![4.0, 1.0, 3.0]).unwrap();
    let sum = one.plus(2.0, &one.with_values(vec![1.0, 0.5, 0.25]).unwrap()).unwrap();
    assert_eq!(sum.entries().map(|entry| entry.2).collect::<Vec<_>>(), [6.0, 2.0, 3.5]);
    let mut shifted = sum.clone();
    shifted.add_to_diagonal([1.0, -0.5]);
    assert_eq!(shifted.diagonal().collect::<Vec<_>>(), [7.0, 3.0]);
    assert!(one.with_values(vec![1.0; 2]).is_err());
    let other = SymmetricMatrix::new(vec![0, 1, 2], vec![0, 1], vec![1.0; 2]).unwrap();
    assert!(one.plus(1.0, &other).is_err());
}
