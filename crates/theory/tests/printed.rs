//! What the paper prints, against the theory: the rows of `docs/corrections.md`.

#![allow(clippy::unwrap_used, reason = "a test may fail anywhere")]

use voronudge_theory::{
    MeanField, Moduli, Orientation, Parameters, SymmetryPoint, hexagon_perimeter, hexagon_side,
};

const CASES: [(f64, f64); 4] = [(3.0, 0.0), (3.0, 0.3), (3.5, -0.2), (4.0, 1.0)];

fn theory(preferred_perimeter: f64, chirality: f64) -> MeanField {
    MeanField::new(Parameters { preferred_perimeter, chirality, ..Parameters::default() }).unwrap()
}

fn along_x(theory: &MeanField, q: f64) -> [[f64; 2]; 2] {
    theory.dynamical_matrix([q, 0.0], Orientation::NeighbourAlongY).unwrap()
}

fn assert_near(found: [[f64; 2]; 2], expected: [[f64; 2]; 2], tolerance: f64) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < tolerance, "{found} {expected}");
    }
}

/// The lattice sum of the SI, term by term as printed, K_P = 1.
fn printed_sum(q: [f64; 2], p_0: f64, alpha: f64) -> [[f64; 2]; 2] {
    let (d, r) = (hexagon_side(), 3f64.sqrt());
    let neighbours = Orientation::NeighbourAlongY.neighbours();
    // a(n) with n from 1 and any period; b(n) = [a(n+1) + a(n+2)]/3.
    let a = |n: usize| neighbours[(n + 5) % 6];
    let b = |n: usize| [0, 1].map(|i| (a(n + 1)[i] + a(n + 2)[i]) / 3.0);
    let weight = |v: [f64; 2], factor: f64| 1.0 - (factor * (q[0] * v[0] + q[1] * v[1])).cos();
    let mut sum = [[0.0; 2]; 2];
    let mut add = |coefficient: f64, left: [f64; 2], right: [f64; 2]| {
        for i in 0..2 {
            for j in 0..2 {
                sum[i][j] += coefficient * left[i] * right[j];
            }
        }
    };
    for n in 7..13 {
        let (near, second, twice) = (weight(a(n), 1.0), weight(b(n), 3.0), weight(a(n), 2.0));
        let (pair, odd) = (1.0 / (9.0 * d * d), alpha / (3.0 * r * d * d));
        add(2.0 * (6.0 * d - p_0) / (3.0 * d.powi(3)) * near, b(n), b(n));
        add(-pair * second, a(n - 1), a(n + 1));
        add(-pair * second, a(n + 1), a(n - 1));
        add(pair * near, a(n - 1), a(n + 1));
        add(pair * near, a(n + 1), a(n - 1));
        add(pair * twice, a(n), a(n));
        add(-12.0 * odd * near, a(n), b(n));
        add(-24.0 * odd * near, b(n + 1), b(n + 1));
        add(24.0 * odd * near, b(n - 1), b(n - 1));
        add(-odd * near, b(n - 1), a(n + 1));
        add(-odd * near, b(n + 1), a(n - 1));
        add(-odd * twice, b(n), a(n));
        add(odd * second, b(n - 1), a(n + 1));
        add(odd * second, b(n + 1), a(n - 1));
    }
    sum
}

#[test]
fn the_printed_lattice_sum_is_the_dynamical_matrix() {
    for (p_0, alpha) in CASES {
        for k in 1..=30 {
            let q = [5.0 * (1.7 * f64::from(k)).sin(), 5.0 * (2.9 * f64::from(k)).cos()];
            let found = theory(p_0, alpha).dynamical_matrix(q, Orientation::NeighbourAlongY).unwrap();
            assert_near(found, printed_sum(q, p_0, alpha), 1e-12);
        }
    }
}

#[test]
fn the_printed_matrix_along_x_has_the_other_chirality() {
    let d = hexagon_side();
    for (p_0, alpha) in CASES {
        for q in [0.2, 1.0, 2.2] {
            let (cos, sin) = ((1.5 * d * q).cos(), (0.75 * d * q).sin());
            let printed = [
                [(4.0 + 2.0 * cos) * d - p_0 / 3.0, 2.0 * alpha * d],
                [(-4.0 + 2.0 * cos) * alpha * d, 6.0 * d - p_0],
            ]
            .map(|row| row.map(|entry| 4.0 * sin * sin / d * entry));
            assert_near(along_x(&theory(p_0, -alpha), q), printed, 1e-12);
        }
    }
}

#[test]
fn long_waves_along_x() {
    let (d, q) = (hexagon_side(), 1e-3);
    for (p_0, alpha) in CASES {
        let found = along_x(&theory(p_0, alpha), q).map(|row| row.map(|entry| entry / (0.75 * d * q * q)));
        let expected = [[18.0 * d - p_0, -6.0 * alpha * d], [6.0 * alpha * d, 3.0 * (6.0 * d - p_0)]];
        // The next order is q² times a few.
        assert_near(found, expected, 1e-4);
    }
}

#[test]
fn the_matrix_of_the_critical_mode() {
    let d = hexagon_side();
    let q = Orientation::NeighbourAlongY.wave_vector(SymmetryPoint::M)[0];
    for (p_0, alpha) in CASES {
        let expected = [[(6.0 * d - p_0) / 3.0, -2.0 * alpha * d], [6.0 * alpha * d, 6.0 * d - p_0]];
        let found = along_x(&theory(p_0, alpha), q).map(|row| row.map(|entry| entry * d / 4.0));
        assert_near(found, expected, 1e-13);
    }
}

/// The printed decimals: μ and the size of Kᵒ hold, B is a third of what it must be.
#[test]
fn the_moduli_in_decimals() {
    let Moduli { bulk, shear, odd_shear, .. } = theory(3.0, 1.0).moduli();
    assert!((bulk - 3.0 * 0.31 * 3.0).abs() < 0.01);
    assert!((shear - 1.4 * (3.72 - 3.0)).abs() < 0.01);
    assert!((odd_shear + 1.73).abs() < 0.01);
    assert!((bulk - hexagon_perimeter() * 3.0 / 4.0).abs() < 1e-14);
}

/// The printed estimate: 0.46 < |v_y/(α v_x)| < 0.61 for 3 < P_0 < 5; the sign is that of α.
#[test]
fn the_flow_follows_the_sign_of_alpha() {
    for alpha in [-1.0, 1.0] {
        for p_0 in [3.0, 4.0, 5.0] {
            let ratio = theory(p_0, alpha).transverse_flow().unwrap() / alpha;
            assert!(ratio > 0.455 && ratio < 0.61, "{ratio}");
        }
    }
}
