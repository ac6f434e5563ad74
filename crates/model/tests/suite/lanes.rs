//! Several cells at once are as one after another.

use crate::samples::{jittered, parameters, periodic, random};
use num_dual::Dual64;
use std::error::Error;
use voronudge_geometry::{Domain, Tessellation, Vector, lift};
use voronudge_model::{Model, velocities};

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

/// Dual numbers go through the elements one by one, in the same operations.
#[test]
fn forces_in_lanes_are_those_of_one_cell_after_another_to_the_last_bit() -> Result<(), Box<dyn Error>> {
    let model = Model::chiral_voronoi(&parameters());
    let box_of = |side: f64| periodic([side, side]);
    let mut sides = Vec::new();
    for (positions, domain) in [
        (random(1, [1.0, 1.0], 3), box_of(1.0)?),
        (random(5, [2.0, 2.5], 4), periodic([2.0, 2.5])?),
        (random(3000, [50.0, 60.0], 5), periodic([50.0, 60.0])?),
        (jittered(40, 40, 0.4, 6), Domain::Open),
        (rosette(24), Domain::Open),
    ] {
        let tessellation = Tessellation::new(&positions, domain)?;
        sides.extend((0..positions.len()).map(|cell| tessellation.neighbours(cell).len()));
        let one_by_one = velocities(&tessellation, &lift::<Dual64>(&positions), &model.lift());
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
