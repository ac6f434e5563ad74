//! Linearity, the gauge, momentum, the mirror.

use crate::samples::{difference, jittered, largest, parameters, periodic, random};
use std::sync::Arc;
use voronudge_geometry::{CellPolygon, Domain, Error, Tessellation, Vector, areas, perimeters};
use voronudge_model::{
    Model, Parameters, base_terms, cell_stresses, columns, parameter_derivatives, stress, velocities,
};

#[test]
fn the_preferred_area_is_a_gauge() -> Result<(), Error> {
    let lengths = [10.0, 10.0];
    for (positions, domain) in [
        (random(100, lengths, 1), periodic(lengths)?),
        (jittered(10, 10, 0.35, 2), periodic(lengths)?),
        (jittered(10, 10, 0.35, 3), Domain::Open),
    ] {
        let tessellation = Tessellation::new(&positions, domain)?;
        let at = |preferred_area| {
            let model = Model::chiral_voronoi(&Parameters { preferred_area, ..parameters() });
            let v = velocities(&tessellation, &positions, &model);
            v.into_iter().filter(|v| v.x.is_finite()).collect::<Vec<_>>()
        };
        let reference = at(1.0);
        assert!(reference.len() > 30);
        for preferred_area in [0.0, 0.5, 2.0] {
            let change = difference(&at(preferred_area), &reference) / largest(&reference);
            assert!(change < 1e-13, "{change:.1e}");
        }
    }
    Ok(())
}

#[test]
fn velocities_are_linear_in_the_coefficients() -> Result<(), Error> {
    let positions = random(150, [12.0, 13.0], 4);
    let tessellation = Tessellation::new(&positions, periodic([12.0, 13.0])?)?;
    let p = parameters();
    let k_p = p.perimeter_elasticity;
    let coefficients = [p.area_elasticity, k_p * p.preferred_perimeter, k_p, k_p * p.chirality];
    let fields = columns(&tessellation, &positions, &base_terms(p.preferred_area), &Arc::default());
    let mut sum = vec![Vector::zeros(); positions.len()];
    for (column, coefficient) in fields.iter().zip(coefficients) {
        for (total, x) in sum.iter_mut().zip(column) {
            *total += x * coefficient;
        }
    }
    let v = velocities(&tessellation, &positions, &Model::chiral_voronoi(&p));
    assert!(difference(&sum, &v) < 1e-13 * largest(&v));
    // Therefore v = K_A ∂v/∂K_A + K_P ∂v/∂K_P: the friction sets both to one time scale.
    let [by_k_a, by_k_p, by_p_0, by_alpha] = parameter_derivatives(&tessellation, &positions, &p);
    for cell in 0..positions.len() {
        let euler = by_k_a[cell] * p.area_elasticity + by_k_p[cell] * k_p;
        assert!((euler - v[cell]).amax() < 1e-13 * largest(&v));
        assert!((by_p_0[cell] - fields[1][cell] * k_p).amax() < 1e-13 * largest(&v));
        assert!((by_alpha[cell] - fields[3][cell] * k_p).amax() < 1e-13 * largest(&v));
    }
    Ok(())
}

#[test]
fn momentum_is_conserved_in_a_box_of_any_size() -> Result<(), Error> {
    for (cells, seed) in [(1, 1), (2, 2), (5, 3), (100, 4), (2000, 5)] {
        let side = f64::from(cells as u32).sqrt();
        let positions = random(cells, [side, side], seed);
        let tessellation = Tessellation::new(&positions, periodic([side, side])?)?;
        let v = velocities(&tessellation, &positions, &Model::chiral_voronoi(&parameters()));
        let total: Vector<f64> = v.iter().sum();
        // A lone cell among its own images is at rest; forces are of order one.
        let scale: f64 = v.iter().map(|v| v.norm() + 1.0).sum();
        assert!(total.norm() < 1e-12 * scale, "{cells} cells");
    }
    Ok(())
}

#[test]
fn a_mirror_reverses_chirality() -> Result<(), Error> {
    let positions = random(100, [10.0, 10.0], 6);
    let mirrored: Vec<_> = positions.iter().map(|r| Vector::new(-r.x, r.y)).collect();
    let domain = periodic([10.0, 10.0])?;
    let (tessellation, image) =
        (Tessellation::new(&positions, domain)?, Tessellation::new(&mirrored, domain)?);
    let model = |chirality| Model::chiral_voronoi(&Parameters { chirality, ..parameters() });
    let v = velocities(&tessellation, &positions, &model(0.7));
    let expected: Vec<_> = v.iter().map(|v| Vector::new(-v.x, v.y)).collect();
    let found = velocities(&image, &mirrored, &model(-0.7));
    assert!(difference(&found, &expected) < 1e-11 * largest(&v));
    assert!(difference(&velocities(&image, &mirrored, &model(0.7)), &expected) > 0.1 * largest(&v));
    Ok(())
}

#[test]
fn the_chiral_turn_acts_on_vertices_and_not_on_centres() -> Result<(), Error> {
    let positions = random(100, [10.0, 10.0], 7);
    let tessellation = Tessellation::new(&positions, periodic([10.0, 10.0])?)?;
    let fields = columns(&tessellation, &positions, &base_terms(1.0), &Arc::default());
    // Contractility is −P ∂P/∂r_v; turning the velocity of the centre instead would give ẑ × (−column).
    let turned: Vec<_> = fields[2].iter().map(|v| -Vector::new(-v.y, v.x)).collect();
    assert!(difference(&fields[3], &turned) > 0.1 * largest(&turned));
    Ok(())
}

#[test]
fn the_antisymmetric_stress_is_the_density_of_torques() -> Result<(), Error> {
    let side = 8.0;
    let positions = random(64, [side, side], 8);
    let tessellation = Tessellation::new(&positions, periodic([side, side])?)?;
    let p = parameters();
    let sigma = stress(&tessellation, &positions, &Model::chiral_voronoi(&p), |_| true);
    let of_a_cell = |perimeter: f64| p.perimeter_elasticity * p.chirality * perimeter * perimeter;
    let perimeters = perimeters(&tessellation, &positions);
    let torque: f64 = perimeters.iter().copied().map(of_a_cell).sum();
    let (found, expected) = (sigma[0][1] - sigma[1][0], torque / (side * side));
    assert!((found - expected).abs() < 1e-11 * expected.abs(), "{found} {expected}");
    // So it is in each cell, and the stress of all is their mean, weighted by areas.
    let (own, areas) = (
        cell_stresses(&tessellation, &positions, &Model::chiral_voronoi(&p)),
        areas(&tessellation, &positions),
    );
    for ((own, area), perimeter) in own.iter().zip(&areas).zip(&perimeters) {
        let (found, expected) = ((own[0][1] - own[1][0]) * area, of_a_cell(*perimeter));
        assert!((found - expected).abs() < 1e-11 * expected.abs(), "{found} {expected}");
    }
    for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let mean: f64 =
            own.iter().zip(&areas).map(|(own, area)| own[row][column] * area).sum::<f64>() / (side * side);
        assert!((mean - sigma[row][column]).abs() < 1e-11 * torque.abs(), "{mean} {}", sigma[row][column]);
    }
    Ok(())
}

#[test]
fn achiral_stress_is_symmetric_and_its_trace_is_the_work_of_dilation() -> Result<(), Error> {
    let side = 8.0;
    let positions = random(64, [side, side], 8);
    let tessellation = Tessellation::new(&positions, periodic([side, side])?)?;
    let p = Parameters { chirality: 0.0, ..parameters() };
    let sigma = stress(&tessellation, &positions, &Model::chiral_voronoi(&p), |_| true);
    assert!((sigma[0][1] - sigma[1][0]).abs() < 1e-12 * sigma[0][0].abs());
    // E(λ) for r → λ r: A → λ² A, P → λ P. tr σ = (1/S) dE/dλ at λ = 1.
    let mut polygon = CellPolygon::<f64>::default();
    let work: f64 = (0..positions.len())
        .map(|cell| {
            polygon.fill(&tessellation, &positions, cell);
            let shape = polygon.shape();
            p.area_elasticity * (shape.area - p.preferred_area) * 2.0 * shape.area
                + p.perimeter_elasticity * (shape.perimeter - p.preferred_perimeter) * shape.perimeter
        })
        .sum();
    let trace = sigma[0][0] + sigma[1][1];
    assert!((trace - work / (side * side)).abs() < 1e-11 * trace.abs(), "{trace}");
    Ok(())
}
