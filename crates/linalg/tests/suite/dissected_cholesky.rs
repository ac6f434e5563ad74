//! Factors by fronts against those of another order.

use crate::sample;
use voronudge_linalg::{Cholesky, DissectedPattern, Dissections, Error, SymmetricMatrix};

/// Entries of the factor's inverse, all of them, against solutions for unit vectors; solutions and determinant against another order. The
/// places of some nodes are not known.
#[test]
fn factor_and_inverse_are_those_of_another_order() {
    for side in [1, 3, 14, 40] {
        let matrix = sample::symmetric(side);
        let n = matrix.order();
        let places: Vec<Option<[f64; 3]>> = (0..side * side)
            .map(|k| (k != 7).then_some([(k % side) as f64, (k / side) as f64, 0.0]))
            .collect();
        let pattern = DissectedPattern::new(&matrix, &places).unwrap();
        let factor = pattern.factor(&matrix).unwrap();
        let other = Cholesky::new(&matrix).unwrap();
        let expected = other.log_determinant();
        assert!((factor.log_determinant() - expected).abs() < 1e-12 * expected.abs().max(1.0));
        let given: Vec<f64> = (0..3 * n).map(|i| (i as f64).sin()).collect();
        let [mut x, mut y] = [given.clone(), given];
        factor.solve(&mut x);
        other.solve(&mut y);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-13));
        let mut drawn: Vec<f64> = (0..n).map(|i| (2.0 * i as f64).cos()).collect();
        let independent: f64 = drawn.iter().map(|z| z * z).sum();
        factor.draw(&mut drawn);
        let twice = |i: usize, j: usize| if i == j { 1.0 } else { 2.0 };
        let form: f64 = matrix.entries().map(|(i, j, a)| twice(i, j) * a * drawn[i] * drawn[j]).sum();
        assert!((form - independent).abs() < 1e-11 * independent);
        let inverse = factor.selected_inverse().unwrap();
        let mut known = 0;
        for j in (0..n).step_by(37) {
            let mut column = vec![0.0; n];
            column[j] = 1.0;
            other.solve(&mut column);
            for (i, exact) in column.iter().enumerate() {
                let Some(entry) = inverse.entry(i, j) else { continue };
                known += 1;
                assert_eq!(inverse.entry(j, i), Some(entry));
                assert!((entry - exact).abs() < 1e-13, "{i} {j}: {entry} {exact}");
            }
        }
        assert!(known >= n.min(25) * n / 37, "{known}");
        assert!(matrix.entries().all(|(i, j, _)| inverse.entry(i, j).is_some()));
    }
}

#[test]
fn an_indefinite_matrix_is_refused() {
    let matrix = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 1.0]).unwrap();
    let pattern = DissectedPattern::new(&matrix, &[Some([0.0; 3])]).unwrap();
    assert_eq!(pattern.factor(&matrix).err(), Some(Error::NotPositiveDefinite));
    assert!(DissectedPattern::new(&matrix, &[None; 3]).is_err());
}

/// The second unknown is all but lost beside the first: what is left of it is what its own diagonal entry is raised by, not nothing.
#[test]
fn what_is_lost_in_rounding_beside_something_large_is_held() {
    let uneven = |large: f64| {
        let values = vec![large, large, large * (1.0 - 1e-15), 1.0, 1.0, 1.0];
        SymmetricMatrix::new(vec![0, 2, 3, 4, 5, 6], vec![0, 1, 1, 2, 3, 4], values).unwrap()
    };
    let factored = |mut matrix: SymmetricMatrix| {
        let pattern = DissectedPattern::new(&matrix, &[None; 5]).unwrap();
        assert_eq!(pattern.factor(&matrix).err(), Some(Error::NotPositiveDefinite));
        let mut x = vec![0.0, 0.0, 1.0, 1.0, 1.0];
        pattern.factor_raised(&mut matrix).map(|factor| {
            factor.solve(&mut x);
            x
        })
    };
    let solved = factored(uneven(1e16)).unwrap();
    assert!(solved[2..].iter().all(|x| (x - 1.0).abs() < 1e-10), "{solved:?}");
    assert_eq!(factored(uneven(1.0)).err(), Some(Error::NotPositiveDefinite));
}

/// Whatever was asked for before, factors are to the last bit those of an order that is found anew, for patterns and places in turn.
#[test]
fn what_is_remembered_is_what_is_found_anew() {
    let cases: Vec<(SymmetricMatrix, Vec<Option<[f64; 3]>>)> = [(14, 1.0), (14, -1.0), (9, 1.0)]
        .into_iter()
        .map(|(side, along)| {
            let place = |k: usize| Some([along * (k % side) as f64, (k / side) as f64 + along, 0.0]);
            (sample::symmetric(side), (0..side * side).map(place).collect())
        })
        .collect();
    let determinant = |pattern: Result<DissectedPattern, Error>, matrix: &SymmetricMatrix| {
        pattern.unwrap().factor(matrix).unwrap().log_determinant().to_bits()
    };
    let known = Dissections::default();
    for (matrix, places) in cases.iter().cycle().take(7) {
        let anew = determinant(DissectedPattern::new(matrix, places), matrix);
        assert_eq!(determinant(known.clone().of(matrix, places), matrix), anew);
    }
}

#[test]
fn a_pattern_is_for_its_matrices_alone() {
    let diagonal = SymmetricMatrix::new((0..=4).collect(), (0..4).collect(), vec![1.0; 4]).unwrap();
    let places = [Some([0.0; 3]); 4];
    let pattern = DissectedPattern::new(&diagonal, &places).unwrap();
    let coupled =
        SymmetricMatrix::new(vec![0, 2, 3, 4, 5], vec![0, 1, 1, 2, 3], vec![1.0, 0.5, 1.0, 1.0, 1.0]);
    let coupled = coupled.unwrap();
    assert!(matches!(pattern.factor(&coupled), Err(Error::Malformed(_))));
    // Of two places with two unknowns each, all are coupled to all.
    assert!(matches!(DissectedPattern::new(&diagonal, &places[..2]), Err(Error::Malformed(_))));
}
