//! Exponentials of matrices and their logarithms.

use voronudge_observables::RateMatrix;

/// The derivative is −D exp(−Dt), for real, complex and nearly equal eigenvalues.
#[test]
fn it_solves_the_equation() {
    for matrix in [
        RateMatrix([[2.0, 0.3], [0.7, 0.5]]),
        RateMatrix([[1.0, -0.8], [0.9, 1.1]]),
        RateMatrix([[1.0, 1e-9], [1e-9, 1.0]]),
        RateMatrix([[1.0, 0.5], [0.0, 1.0]]),
    ] {
        let (t, h) = (0.8, 1e-5);
        let v = [0.4, -1.2];
        let at = |t: f64| matrix.propagator(t).apply(v);
        let (later, earlier, now) = (at(t + h), at(t - h), at(t));
        let expected = matrix.apply(now);
        for axis in 0..2 {
            assert!(((later[axis] - earlier[axis]) / (2.0 * h) + expected[axis]).abs() < 1e-8);
        }
    }
    assert_eq!(RateMatrix::ZERO.propagator(3.0), RateMatrix::IDENTITY);
}

/// The logarithm undoes the exponential, also where a wave turns by more than a quarter, and there is none of what no wave does.
#[test]
fn the_logarithm_finds_the_rates_again() {
    let matrices = [
        [[2.0, 0.3], [0.7, 0.5]],
        [[0.3, -1.8], [1.9, 0.2]],
        [[1.0, 1e-9], [1e-9, 1.0]],
        [[1.0, 0.5], [0.0, 1.0]],
    ];
    for rates in matrices.map(RateMatrix) {
        let found = RateMatrix::of_propagator(rates.propagator(1.3), 1.3).unwrap();
        assert!((found - rates).0.iter().flatten().all(|entry| entry.abs() < 1e-9), "{found:?}");
        let back = rates.propagator(0.4) * rates.propagator(-0.4) - RateMatrix::IDENTITY;
        assert!(back.0.iter().flatten().all(|entry| entry.abs() < 1e-14));
    }
    assert_eq!(RateMatrix::of_propagator(RateMatrix([[0.5, 0.0], [0.0, -0.1]]), 1.0), None);
    assert_eq!(RateMatrix::of_propagator(RateMatrix([[-0.5, 0.0], [0.0, -0.1]]), 1.0), None);
}
