//! The order of elimination, by the entries of the inverse that it gives.

use crate::sample;
use voronudge_linalg::{DissectedPattern, SymmetricMatrix};

/// `1 − A` of a periodic lattice without an antisymmetric part, which is positive definite.
fn periodic(side: usize) -> SymmetricMatrix {
    let lattice = sample::stencil(side, 0.0);
    let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
    for unknown in 0..2 * side * side {
        let (node, part) = (unknown / 2, unknown % 2);
        for at in lattice.start[node]..lattice.start[node + 1] {
            for k in 0..2 {
                let other = 2 * lattice.column[at] as usize + k;
                if other >= unknown {
                    row.push(other);
                    value.push(f64::from(u8::from(other == unknown)) - lattice.block[at][2 * part + k]);
                }
            }
        }
        start.push(row.len());
    }
    SymmetricMatrix::new(start, row, value).unwrap()
}

/// `A x` against `b` of a solution by fronts.
fn assert_solved(matrix: &SymmetricMatrix, pattern: &DissectedPattern) {
    let given: Vec<f64> = (0..matrix.order()).map(|i| (i as f64).sin()).collect();
    let mut x = given.clone();
    pattern.factor(matrix).unwrap().solve(&mut x);
    let mut product = vec![0.0; x.len()];
    for (i, j, a) in matrix.entries() {
        product[i] += a * x[j];
        if i != j {
            product[j] += a * x[i];
        }
    }
    assert!(product.iter().zip(&given).all(|(own, b)| (own - b).abs() < 1e-12));
}

/// A node that were eliminated twice, or not, would have no solution; what a node couples to is in its front, and what is in a front of those
/// behind meets there again.
#[test]
fn every_node_is_eliminated_once_and_knows_what_it_couples_to() {
    let side = 23;
    let matrix = periodic(side);
    let n = matrix.order();
    let places: Vec<_> = sample::places(side).into_iter().map(|[x, y]| Some([x, y, 0.0])).collect();
    let pattern = DissectedPattern::new(&matrix, &places).unwrap();
    assert_solved(&matrix, &pattern);
    let inverse = pattern.factor(&matrix).unwrap().selected_inverse().unwrap();
    assert!(matrix.entries().all(|(i, j, _)| inverse.entry(i, j).is_some()));
    let entries: usize = (0..n).map(|i| (0..n).filter(|&j| inverse.entry(i, j).is_some()).count()).sum();
    // A tenth of the dense matrix.
    assert!(entries < n.pow(2) / 2, "{entries}");
}

/// Places that tell nothing: the order is poor, not wrong.
#[test]
fn coinciding_places_are_no_obstacle() {
    let matrix = periodic(9);
    let pattern = DissectedPattern::new(&matrix, &[Some([0.0; 3]); 81]).unwrap();
    assert_solved(&matrix, &pattern);
    let inverse = pattern.factor(&matrix).unwrap().selected_inverse().unwrap();
    assert!((0..162).all(|i| (0..162).all(|j| inverse.entry(i, j).is_some())));
}
