//! Several cells at once are as one after another.

use crate::samples::{Tissue, jittered, parameters, periodic, random};
use num_dual::DualSVec64;
use std::error::Error;
use voronudge_geometry::{Domain, Tessellation, Vector, lift};
use voronudge_model::{Effect, Model, jacobian, jvp, velocities, vjp};

/// One cell in a ring of many, and the rest of a tissue around them.
fn rosette(petals: usize) -> Vec<Vector<f64>> {
    let turn = |k: usize, n: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let circle = |n: usize, radius: f64| {
        (0..n).map(move |k| {
            Vector::new(turn(k, n).cos(), 1.01 * turn(k, n).sin()) * (radius + 0.01 * (k % 3) as f64)
        })
    };
    let mut cells = vec![Vector::new(0.02, 0.01)];
    cells.extend(circle(petals, 1.0).chain(circle(petals, 1.5)).chain(circle(petals, 2.2)));
    cells
}

/// Boxes in which cells meet themselves, a large one, open fields numbered in rows and at random, cells of many sides.
fn tissues() -> Result<Vec<Tissue>, voronudge_geometry::Error> {
    Ok(vec![
        (random(1, [1.0, 1.0], 3), periodic([1.0, 1.0])?),
        (random(5, [2.0, 2.5], 4), periodic([2.0, 2.5])?),
        (random(3000, [50.0, 60.0], 5), periodic([50.0, 60.0])?),
        (jittered(40, 40, 0.4, 6), Domain::Open),
        (random(2000, [50.0, 40.0], 7), Domain::Open),
        (rosette(24), Domain::Open),
    ])
}

/// Dual numbers of several directions go through the elements one by one, in the same operations.
#[test]
fn forces_in_lanes_are_those_of_one_cell_after_another_to_the_last_bit() -> Result<(), Box<dyn Error>> {
    let model = Model::chiral_voronoi(&parameters());
    let mut sides = Vec::new();
    for (positions, domain) in tissues()? {
        let tessellation = Tessellation::new(&positions, domain)?;
        sides.extend((0..positions.len()).map(|cell| tessellation.neighbours(cell).len()));
        let one_by_one = velocities(&tessellation, &lift::<DualSVec64<1>>(&positions), &model.lift());
        for (cell, (v, one)) in
            velocities(&tessellation, &positions, &model).iter().zip(one_by_one).enumerate()
        {
            let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
            assert!(same(v.x, one.x.re) && same(v.y, one.y.re), "cell {cell}: {v} {}", one.x.re);
        }
    }
    assert!(sides.contains(&4) && sides.contains(&9) && sides.contains(&24));
    Ok(())
}

#[test]
fn products_with_the_jacobian_are_those_of_the_matrix() -> Result<(), Box<dyn Error>> {
    let base = Model::chiral_voronoi(&parameters());
    for (positions, domain) in tissues()? {
        let tessellation = Tessellation::new(&positions, domain)?;
        let field = |seed: f64| -> Vec<Vector<f64>> {
            (0..positions.len())
                .map(|i| Vector::new((seed + i as f64).sin(), (seed * i as f64).cos()))
                .collect()
        };
        let (u, w) = (field(0.7), field(1.3));
        for id in ["", "alpha_area", "nematic_stress", "friction_gradient"] {
            let columns = Effect::from_id(id)
                .map_or(Ok(Vec::new()), |effect| effect.columns(&base.environment, domain));
            // Some effects need an open field.
            let Ok(columns) = columns else { continue };
            let model = columns.into_iter().fold(base.clone(), |model, column| model.with(column, 0.1));
            let matrix = jacobian(&tessellation, &positions, &model);
            let scale =
                1.0 + matrix.block.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
            let close = |found: Vec<Vector<f64>>, expected: Vec<Vector<f64>>, what: &str| {
                assert_eq!(found.len(), expected.len());
                for (cell, (found, expected)) in found.iter().zip(&expected).enumerate() {
                    let error = (found - expected).amax() / scale;
                    assert!(error < 1e-11, "{what}, {id}, cell {cell}: {found} {expected}");
                }
            };
            close(jvp(&tessellation, &positions, &model, &u), matrix.apply(&u), "jvp");
            close(vjp(&tessellation, &positions, &model, &w), matrix.apply_transposed(&w), "vjp");
        }
    }
    Ok(())
}
