//! Mean-field theory: closed forms on the honeycomb, computed from its geometry.

use crate::samples::{honeycomb, largest, parameters, periodic};
use voronudge_geometry::{Error, PeriodicBox, Tessellation, Vector};
use voronudge_model::{ForceTerm, Model, Parameters, Parity, Term, jacobian, stress, velocities};

/// Perimeter 6d of a regular hexagon of unit area, `3√3/2 d² = 1`.
fn hexagon_perimeter() -> f64 {
    6.0 * (2.0 / (3.0 * 3f64.sqrt())).sqrt()
}

fn tissue(preferred_perimeter: f64, chirality: f64) -> Parameters<f64> {
    Parameters { area_elasticity: 0.0, preferred_perimeter, chirality, ..parameters() }
}

/// Stress of a honeycomb under the homogeneous deformation `r → diag(x, y) r`.
fn stretched(p: &Parameters<f64>, x: f64, y: f64) -> Result<[[f64; 2]; 2], Error> {
    let (positions, lengths) = honeycomb(6, 6);
    let moved: Vec<_> = positions.iter().map(|r| Vector::new(x * r.x, y * r.y)).collect();
    let tessellation = Tessellation::new(&moved, periodic([x * lengths[0], y * lengths[1]])?)?;
    let model = Model::chiral_voronoi(p);
    // Every cell is a centre of inversion: there is no motion beside the deformation itself.
    assert!(largest(&velocities(&tessellation, &moved, &model)) < 1e-12);
    Ok(stress(&tessellation, &moved, &model, |_| true))
}

#[test]
fn no_term_between_cells_moves_a_honeycomb() -> Result<(), Error> {
    let (positions, lengths) = honeycomb(10, 8);
    let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
    let acts_within = |term: &Term| term.conserves_momentum() && term.parity() != Parity::Oriented;
    for term in Term::all().into_iter().filter(acts_within) {
        let v = velocities(&tessellation, &positions, &Model::single(term));
        assert!(largest(&v) < 1e-13, "{term:?}");
    }
    Ok(())
}

#[test]
fn prestress_is_that_of_mean_field_theory() -> Result<(), Error> {
    for (p_0, alpha) in [(3.0, 0.3), (3.5, -0.2), (3.9, 1.0), (3.0, 0.0)] {
        let p = tissue(p_0, alpha);
        let p_mf = hexagon_perimeter();
        let (s, scale) = (1.0 - p_0 / p_mf, p.perimeter_elasticity * p_mf * p_mf / 2.0);
        let sigma = stretched(&p, 1.0, 1.0)?;
        let expected = [[s, alpha], [-alpha, s]];
        for row in 0..2 {
            for column in 0..2 {
                let error = sigma[row][column] - scale * expected[row][column];
                assert!(error.abs() < 1e-12 * scale, "σ[{row}][{column}] = {}", sigma[row][column]);
            }
        }
    }
    Ok(())
}

#[test]
fn dilation_meets_the_bulk_modulus() -> Result<(), Error> {
    for (p_0, alpha) in [(3.0, 0.3), (3.5, -0.2), (3.5, 1.0)] {
        let p = tissue(p_0, alpha);
        let e = 1e-4;
        let (plus, minus) = (stretched(&p, 1.0 + e, 1.0 + e)?, stretched(&p, 1.0 - e, 1.0 - e)?);
        let slope = |row: usize, column: usize| (plus[row][column] - minus[row][column]) / (2.0 * e);
        // σ_iso = B ∇·u with ∇·u = 2e; B = 3 K_P P_0 d / (2Ā); odd bulk modulus A = 0.
        let bulk = (slope(0, 0) + slope(1, 1)) / 4.0;
        let expected = p.perimeter_elasticity * p_0 * hexagon_perimeter() / 4.0;
        // Central differences leave errors of order e².
        assert!((bulk / expected - 1.0).abs() < 1e-7, "{bulk}");
        assert!((slope(1, 0) - slope(0, 1)).abs() < 1e-7);
        assert!((slope(0, 0) - slope(1, 1)).abs() < 1e-7);
    }
    Ok(())
}

#[test]
fn pure_shear_meets_the_shear_moduli() -> Result<(), Error> {
    for (p_0, alpha) in [(3.0, 0.3), (3.5, -0.2), (3.5, 1.0)] {
        let p = tissue(p_0, alpha);
        let e = 1e-4;
        let (plus, minus) = (stretched(&p, 1.0 + e, 1.0 - e)?, stretched(&p, 1.0 - e, 1.0 + e)?);
        let slope = |row: usize, column: usize| (plus[row][column] - minus[row][column]) / (2.0 * e);
        // shear₁ = ∂_x u_x − ∂_y u_y = 2e: (σ_xx − σ_yy)/2 = μ shear₁, (σ_xy + σ_yx)/2 = −K° shear₁.
        let (p_mf, k_p) = (hexagon_perimeter(), p.perimeter_elasticity);
        let shear = (slope(0, 0) - slope(1, 1)) / 4.0;
        let odd = -(slope(0, 1) + slope(1, 0)) / 4.0;
        let unit = k_p * p_mf * p_mf / 8.0;
        assert!((shear / (3.0 * (1.0 - p_0 / p_mf) * unit) - 1.0).abs() < 1e-6, "μ = {shear}");
        assert!((odd / (-alpha * unit) - 1.0).abs() < 1e-6, "K° = {odd}");
    }
    Ok(())
}

#[test]
fn a_simple_shear_that_maps_the_lattice_onto_itself_restores_the_stress() -> Result<(), Error> {
    let (positions, [x, y]) = honeycomb(6, 6);
    let gamma = x / y;
    let slid: Vec<_> = positions.iter().map(|r| Vector::new(r.x + gamma * r.y, r.y)).collect();
    let sheared = voronudge_geometry::Domain::Periodic(PeriodicBox::sheared([x, y], gamma * y)?);
    let tessellation = Tessellation::new(&slid, sheared)?;
    let p = tissue(3.4, 0.6);
    let sigma = stress(&tessellation, &slid, &Model::chiral_voronoi(&p), |_| true);
    let reference = stretched(&p, 1.0, 1.0)?;
    for (row, expected) in sigma.iter().zip(&reference) {
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
    }
    Ok(())
}

#[test]
fn plane_waves_obey_the_dispersion_relation() -> Result<(), Error> {
    let (positions, lengths) = honeycomb(12, 8);
    let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
    let (p_mf, d) = (hexagon_perimeter(), hexagon_perimeter() / 6.0);
    for (p_0, alpha) in [(3.0, 0.3), (3.5, -0.2)] {
        let p = tissue(p_0, alpha);
        let matrix = jacobian(&tessellation, &positions, &Model::chiral_voronoi(&p));
        for mode in [1.0, 2.0, 5.0] {
            // Rows along x have a lattice vector along x: waves travel perpendicular to it in the formula's frame. Here
            // q is along y, so x and y of the formula are y and −x: a quarter turn of the frame.
            let q = std::f64::consts::TAU * mode / lengths[1];
            let (cos, sin) = ((1.5 * d * q).cos(), (0.75 * d * q).sin());
            let scale = 4.0 * p.perimeter_elasticity * sin * sin / d;
            let expected = [
                [scale * ((4.0 + 2.0 * cos) * d - p_0 / 3.0), scale * -2.0 * alpha * d],
                [scale * (4.0 - 2.0 * cos) * alpha * d, scale * (p_mf - p_0)],
            ];
            let wave = |polarisation: Vector<f64>| -> Vec<Vector<f64>> {
                positions.iter().map(|r| polarisation * (q * r.y).cos()).collect()
            };
            // Along q is y; the second axis, a quarter turn ahead, is −x.
            let axes = [Vector::new(0.0, 1.0), Vector::new(-1.0, 0.0)];
            for (column, axis) in axes.iter().enumerate() {
                let response = matrix.apply(&wave(*axis));
                for (cell, r) in positions.iter().enumerate() {
                    for (row, along) in axes.iter().enumerate() {
                        let predicted = -expected[row][column] * (q * r.y).cos();
                        let error = response[cell].dot(along) - predicted;
                        assert!(error.abs() < 1e-10, "D[{row}][{column}], q = {q}: {error:.1e}");
                    }
                }
            }
        }
    }
    Ok(())
}
