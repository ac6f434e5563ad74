//! Factors of shifted matrices, by what the iteration finds that solves with them.

use crate::sample;
use voronudge_linalg::{BlockSparse, Complex64, Error, Wanted, nearest};

/// `(A − σ 1) x = b` is solved if the eigenvectors of the solver are those of A, and of its transpose likewise: of small matrices all, of large
/// ones, the last of which has fronts that are shared out to threads, some.
#[test]
fn solutions_satisfy_real_and_complex_equations_and_their_transposes() {
    for (side, count) in [(1, 2), (4, 32), (12, 60), (30, 8), (70, 6)] {
        let matrix = sample::lattice(side, 0.8);
        let (transposed, n) = (matrix.transposed(), matrix.order());
        for shift in [Complex64::new(0.3, 0.7), Complex64::new(0.3, 0.0)] {
            let places = sample::places(side);
            let found =
                nearest(&matrix, &places, shift, count, Wanted::RightAndLeft, &mut |_, _, _| {}).unwrap();
            assert_eq!(found.shift, shift);
            assert!(found.pairs.values.len() >= count, "{side} {shift}: {}", found.pairs.values.len());
            for (k, value) in found.pairs.values.iter().enumerate() {
                let vectors = [found.pairs.right(k).unwrap(), found.pairs.left(k).unwrap()];
                for (x, matrix, value) in
                    [(&vectors[0], &matrix, *value), (&vectors[1], &transposed, value.conj())]
                {
                    let mut product = vec![Complex64::ZERO; n];
                    matrix.apply(x, &mut product);
                    let worst = (0..n).map(|i| (product[i] - value * x[i]).norm()).fold(0.0, f64::max);
                    assert!(worst < 1e-11, "{side} {shift} {worst:e}");
                }
            }
        }
    }
}

/// A shift on an eigenvalue leaves no factor, and is moved beside it by 1e-9 of the norm; one between two stays.
#[test]
fn a_singular_matrix_is_refused() {
    let matrix = BlockSparse::new(vec![0, 1], vec![0], vec![[1.0, 0.0, 0.0, 2.0]]).unwrap();
    let shift_of = |shift: f64| {
        let places = [[0.0; 2]];
        nearest(&matrix, &places, shift.into(), 1, Wanted::Right, &mut |_, _, _| {}).unwrap().shift
    };
    assert_eq!(shift_of(2.0), Complex64::from(2.0 + 1e-9 * matrix.norm()));
    assert_eq!(shift_of(1.75), Complex64::from(1.75));
    let refused = nearest(&matrix, &[], Complex64::ZERO, 1, Wanted::Right, &mut |_, _, _| {});
    assert!(matches!(refused, Err(Error::Malformed(_))));
}
