//! The sparse Jacobian: zero modes, sparsity, small boxes.

use crate::samples::{jittered, parameters, periodic, random, sheared};
use num_dual::DualSVec64;
use voronudge_geometry::{Domain, Error, Tessellation, Vector, lift};
use voronudge_model::{Model, jacobian, velocities};

#[test]
fn a_translation_is_a_zero_mode_and_columns_sum_to_zero() -> Result<(), Error> {
    for (cells, seed) in [(3, 1), (12, 2), (200, 3), (1500, 4)] {
        let side = f64::from(cells as u32).sqrt();
        let positions = random(cells, [side, side], seed);
        let tessellation = Tessellation::new(&positions, periodic([side, side])?)?;
        let matrix = jacobian(&tessellation, &positions, &Model::chiral_voronoi(&parameters()));
        let scale = matrix.block.iter().flatten().fold(0.0, |max: f64, entry| max.max(entry.abs()));
        let mut columns = vec![[0.0; 4]; cells];
        for row in 0..cells {
            for (column, block) in matrix.row(row) {
                for (total, entry) in columns[column].iter_mut().zip(block) {
                    *total += entry;
                }
            }
        }
        assert!(columns.iter().flatten().all(|total: &f64| total.abs() < 1e-12 * scale));
        for direction in [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)] {
            let response = matrix.apply(&vec![direction; cells]);
            assert!(response.iter().all(|v| v.amax() < 1e-12 * scale));
        }
    }
    Ok(())
}

#[test]
fn tiny_boxes_agree_with_dual_numbers_through_the_whole_system() -> Result<(), Error> {
    // Cells that neighbour themselves, and each other several times. Ten directions serve up to five cells.
    type Dual = DualSVec64<10>;
    for cells in 1..=5 {
        for seed in 0..20 {
            let side = f64::from(cells as u32).sqrt();
            let domain = sheared([side * 1.3, side / 1.3], 0.17 * seed as f64)?;
            let positions = random(cells, [side * 1.3, side / 1.3], seed);
            let tessellation = Tessellation::new(&positions, domain)?;
            let model = Model::chiral_voronoi(&parameters());
            let mut dual: Vec<Vector<Dual>> = lift(&positions);
            for (cell, r) in positions.iter().enumerate() {
                for axis in 0..2 {
                    dual[cell][axis] = Dual::from_re(r[axis]).derivative(2 * cell + axis);
                }
            }
            let v = velocities(&tessellation, &dual, &model.lift());
            let dense = jacobian(&tessellation, &positions, &model).to_dense();
            let n = 2 * cells;
            let expected =
                |row: usize, column: usize| v[row / 2][row % 2].eps.0.map_or(0.0, |eps| eps[column]);
            // A lone cell has no derivative but the rounding of cancelling forces of order one.
            let scale = dense.iter().fold(1.0, |max: f64, entry| max.max(entry.abs()));
            for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
                let error = dense[row * n + column] - expected(row, column);
                assert!(error.abs() < 1e-11 * scale, "{cells} cells, seed {seed}: {error:.1e}");
            }
        }
    }
    Ok(())
}

#[test]
fn rows_reach_two_rings_and_no_further() -> Result<(), Error> {
    let positions = jittered(20, 20, 0.35, 5);
    let tessellation = Tessellation::new(&positions, periodic([20.0, 20.0])?)?;
    let matrix = jacobian(&tessellation, &positions, &Model::chiral_voronoi(&parameters()));
    assert_eq!(matrix.rows(), 400);
    for row in 0..400 {
        let mut reached: Vec<usize> = vec![row];
        for _ in 0..2 {
            let next: Vec<usize> =
                reached.iter().flat_map(|&i| tessellation.neighbours(i)).map(|&j| j as usize).collect();
            reached.extend(next);
        }
        reached.sort_unstable();
        reached.dedup();
        let mut columns: Vec<usize> = matrix.row(row).map(|(column, _)| column).collect();
        columns.sort_unstable();
        assert!(columns.windows(2).all(|pair| pair[0] < pair[1]), "a column appears once");
        assert!(columns.iter().all(|column| reached.binary_search(column).is_ok()));
        assert!(columns.contains(&row));
    }
    Ok(())
}

#[test]
fn the_dense_matrix_is_the_sparse_one() -> Result<(), Error> {
    let positions = random(30, [5.0, 6.0], 6);
    let tessellation = Tessellation::new(&positions, periodic([5.0, 6.0])?)?;
    let matrix = jacobian(&tessellation, &positions, &Model::chiral_voronoi(&parameters()));
    let dense = matrix.to_dense();
    let field: Vec<_> = positions.iter().map(|r| Vector::new(r.y.sin(), r.x.cos())).collect();
    for (cell, v) in matrix.apply(&field).iter().enumerate() {
        for axis in 0..2 {
            let row = &dense[(2 * cell + axis) * 60..][..60];
            let sum: f64 = row.iter().enumerate().map(|(k, entry)| entry * field[k / 2][k % 2]).sum();
            assert!((sum - v[axis]).abs() < 1e-11 * (1.0 + v[axis].abs()));
        }
    }
    Ok(())
}

#[test]
fn rows_without_a_velocity_are_empty() -> Result<(), Error> {
    let positions = random(120, [11.0, 11.0], 7);
    let tessellation = Tessellation::new(&positions, Domain::Open)?;
    let model = Model::chiral_voronoi(&parameters());
    let (v, matrix) =
        (velocities(&tessellation, &positions, &model), jacobian(&tessellation, &positions, &model));
    for (cell, v) in v.iter().enumerate() {
        assert_eq!(v.x.is_nan(), matrix.row(cell).next().is_none());
    }
    assert!(matrix.block.iter().flatten().all(|entry| entry.is_finite()));
    assert!(v.iter().filter(|v| v.x.is_finite()).count() > 50);
    Ok(())
}
