//! Cholesky factors against matrices of which all is known.

use nalgebra::DMatrix;
use voronudge_linalg::{Cholesky, Error, FactorForm, Scratch, SymmetricMatrix};

#[test]
fn an_indefinite_matrix_is_refused() {
    let matrix = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 1.0]).unwrap();
    assert_eq!(Cholesky::new(&matrix).unwrap_err(), Error::NotPositiveDefinite);
}

/// The form that is chosen, and both.
const FORMS: [Option<FactorForm>; 3] = [None, Some(FactorForm::Simplicial), Some(FactorForm::Supernodal)];

fn factor(matrix: &SymmetricMatrix, form: Option<FactorForm>) -> Cholesky {
    form.map_or_else(|| Cholesky::new(matrix), |form| Cholesky::in_form(matrix, form)).unwrap()
}

/// A five-point Laplacian on a square grid that is held at zero around, plus a shift.
fn laplacian(side: usize, shift: f64) -> SymmetricMatrix {
    let n = side * side;
    let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
    for i in 0..n {
        row.push(i);
        value.push(4.0);
        for j in
            [(i % side + 1 < side).then_some(i + 1), (i + side < n).then_some(i + side)].into_iter().flatten()
        {
            row.push(j);
            value.push(-1.0);
        }
        start.push(row.len());
    }
    let mut matrix = SymmetricMatrix::new(start, row, value).unwrap();
    matrix.shift_diagonal(shift);
    matrix
}

fn times(matrix: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; x.len()];
    for (row, column, value) in matrix.entries() {
        product[row] += value * x[column];
        if row != column {
            product[column] += value * x[row];
        }
    }
    product
}

/// Side by side or one after the other, solutions are the same.
#[test]
fn vectors_side_by_side_are_solved() {
    let matrix = laplacian(6, 0.3);
    let n = matrix.order();
    for form in FORMS {
        let factor = factor(&matrix, form);
        let given: Vec<f64> = (0..3 * n).map(|i| (i as f64).sin()).collect();
        let mut one_by_one = given.clone();
        factor.solve(&mut one_by_one);
        let mut scratch = Scratch::default();
        // One right-hand side, then three in memory that has to grow.
        for sides in [1, 3] {
            let mut beside: Vec<f64> = (0..sides * n).map(|i| given[i % sides * n + i / sides]).collect();
            factor.solve_side_by_side(&mut beside, &mut scratch);
            let is_same = |i: usize| (beside[i] - one_by_one[i % sides * n + i / sides]).abs() < 1e-12;
            assert!((0..sides * n).all(is_same), "{form:?} {sides}");
        }
    }
}

/// Two right-hand sides at once.
#[test]
fn solutions_satisfy_the_equations() {
    let matrix = laplacian(12, 0.3);
    let n = matrix.order();
    let given: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
    for form in FORMS {
        let mut x = given.clone();
        factor(&matrix, form).solve(&mut x);
        for (x, b) in x.chunks(n).zip(given.chunks(n)) {
            let worst = times(&matrix, x).iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-13, "{worst:e}");
        }
    }
}

/// The eigenvalues of the Laplacian are `4 − 2 cos(π j/(s+1)) − 2 cos(π k/(s+1))`, j and k from 1 to s.
#[test]
fn the_log_determinant_of_a_laplacian_is_the_sum_over_its_eigenvalues() {
    let (side, shift) = (60, 0.01);
    let matrix = laplacian(side, shift);
    let wave = |k: usize| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / (side as f64 + 1.0)).cos();
    let expected: f64 =
        (1..=side).flat_map(|j| (1..=side).map(move |k| (shift + wave(j) + wave(k)).ln())).sum();
    for form in FORMS {
        let factor = factor(&matrix, form);
        assert!(form.is_none_or(|form| factor.form() == form));
        let found = factor.log_determinant();
        assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
    }
}

/// Bands with pseudo-random entries.
#[test]
fn log_determinants_agree_with_dense_factors() {
    for (order, band) in [(1, 0), (2, 1), (7, 3), (40, 5), (40, 39)] {
        let columns = || (0..order).map(|column| column..(column + band + 1).min(order));
        let start = std::iter::once(0).chain(columns().scan(0, |end, rows| {
            *end += rows.len();
            Some(*end)
        }));
        let start: Vec<usize> = start.collect();
        let row: Vec<usize> = columns().flatten().collect();
        let value: Vec<f64> = (0..row.len()).map(|k| (7.0 * k as f64).sin()).collect();
        let mut matrix = SymmetricMatrix::new(start, row, value).unwrap();
        matrix.shift_diagonal(2.0 * band as f64 + 1.5);
        for _ in 0..2 {
            let mut dense = DMatrix::zeros(order, order);
            for (row, column, value) in matrix.entries() {
                dense[(row, column)] = value;
            }
            let lower = dense.cholesky().unwrap().unpack();
            let expected = 2.0 * lower.diagonal().map(f64::ln).sum();
            for form in FORMS {
                let found = factor(&matrix, form).log_determinant();
                assert!((found - expected).abs() < 1e-13 * (1.0 + expected.abs()), "{found} {expected}");
            }
            matrix.shift_diagonal(0.7);
        }
    }
}

/// The determinant of the diagonal matrix, 1e-3000, is below the smallest `f64`.
#[test]
fn a_tiny_determinant_has_a_log_determinant() {
    let matrix = SymmetricMatrix::new((0..=1000).collect(), (0..1000).collect(), vec![1e-3; 1000]).unwrap();
    let found = Cholesky::new(&matrix).unwrap().log_determinant();
    assert!((found - 1000.0 * 1e-3f64.ln()).abs() < 1e-9);
}
