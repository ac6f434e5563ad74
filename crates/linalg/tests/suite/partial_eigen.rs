//! Some eigenvalues against all of them.

use crate::sample;
use voronudge_linalg::{BlockSparse, Complex64, Wanted, eigen, nearest, rightmost};

fn silent() -> impl FnMut(&'static str, usize, usize) {
    |_, _, _| {}
}

fn dense(matrix: &BlockSparse, shift: Option<Complex64>) -> Vec<Complex64> {
    let mut values = eigen(&matrix.to_dense(), matrix.order(), Wanted::Values).unwrap().values;
    if let Some(shift) = shift {
        values.sort_by(|a, b| (a - shift).norm().total_cmp(&(b - shift).norm()));
    }
    values
}

#[test]
fn the_nearest_are_those_of_the_dense_matrix() {
    let side = 11;
    let matrix = sample::lattice(side, 0.8);
    for shift in [Complex64::new(0.2, 0.0), Complex64::new(-9.0, 3.0), Complex64::new(-20.0, 0.0)] {
        let wanted = Wanted::RightAndLeft;
        let found = nearest(&matrix, &sample::places(side), shift, 6, wanted, &mut silent()).unwrap();
        let expected = dense(&matrix, Some(shift));
        let inside = expected.iter().filter(|value| (*value - shift).norm() < 0.999 * found.reach);
        let mut count = 0;
        for value in inside {
            count += 1;
            assert!(found.pairs.values.iter().any(|f| (f - value).norm() < 1e-8), "{shift} {value}");
        }
        assert!(count >= 5 && found.pairs.values.len() >= 6);
        let order = matrix.order();
        for k in 0..found.pairs.values.len() {
            assert!(found.residuals[k] < 1e-10);
            let (value, y) = (found.pairs.values[k], found.pairs.left(k).unwrap());
            let mut product = vec![Complex64::ZERO; order];
            matrix.transposed().apply(&y, &mut product);
            let off: f64 = (0..order).map(|i| (product[i] - value.conj() * y[i]).norm()).sum();
            assert!(off < 1e-7, "{off:e}");
            assert!(found.pairs.condition(k, 0.0).unwrap() > 1.0 - 1e-9);
        }
    }
}

/// A spectrum that ends at zero, as a solid's, and one whose rightmost values oscillate.
#[test]
fn the_rightmost_are_those_of_the_dense_matrix() {
    let side = 10;
    let solid = sample::lattice(side, 0.5);
    let mut turning = sample::stencil(side, 0.5);
    for row in [7, 40, 61] {
        let at = (turning.start[row]..turning.start[row + 1]).find(|&k| turning.column[k] as usize == row);
        let b = &mut turning.block[at.unwrap()];
        *b = [3.0 + row as f64 / 50.0, -40.0, 40.0, 3.0];
    }
    for matrix in [solid, turning.matrix()] {
        let found = rightmost(&matrix, &sample::places(side), 5, Wanted::Right, &mut silent()).unwrap();
        let expected = dense(&matrix, None);
        for (k, value) in found.pairs.values.iter().enumerate() {
            assert!((value - expected[k]).norm() < 1e-7, "{k} {value} {}", expected[k]);
            assert!(found.residuals[k] < 1e-10);
        }
        assert!(found.pairs.values.len() >= 5);
    }
}

/// Translations are modes with the eigenvalue zero: the shift may lie on them.
#[test]
fn a_shift_on_an_eigenvalue_is_moved_beside_it() {
    let matrix = sample::lattice(6, 0.5);
    let found =
        nearest(&matrix, &sample::places(6), Complex64::ZERO, 2, Wanted::Right, &mut silent()).unwrap();
    assert!(found.pairs.values.iter().all(|value| value.norm() < 1e-10));
}
