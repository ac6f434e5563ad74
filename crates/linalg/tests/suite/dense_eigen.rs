//! Eigenvalues and vectors of dense matrices.

use crate::sample;
use voronudge_linalg::{Complex64, Error, Wanted, eigen, eigen_complex};

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
