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

/// The shear of a flow up and along a gradient of density, v = c (B + μ, A − Kᵒ) ∂_x ρ: the traceless part of the strain rate in two dimensions.
/// The paper takes a third of the divergence off, and prints (B + μ)/4 on the diagonal.
#[test]
fn the_shear_of_the_flow_along_a_gradient() {
    let Moduli { bulk, odd_bulk, shear, odd_shear } = theory(4.0, 2.9).moduli();
    let (curvature, flow) = (0.7, [-(bulk + shear), -(odd_bulk - odd_shear)]);
    // ∂_x v, as ∂_x of ∂_x ρ; nothing changes along y.
    let gradient = [[flow[0] * curvature, flow[1] * curvature], [0.0, 0.0]];
    let divergence = gradient[0][0] + gradient[1][1];
    let mut rate = [[0.0; 2]; 2];
    for i in 0..2 {
        for j in 0..2 {
            let trace = if i == j { 0.5 * divergence } else { 0.0 };
            rate[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]) - trace;
        }
    }
    let half = 0.5 * (bulk + shear);
    let expected = [[half, 0.5 * (odd_bulk - odd_shear)], [0.5 * (odd_bulk - odd_shear), -half]];
    assert_near(rate, expected.map(|row| row.map(|x| -curvature * x)), 1e-12);
    let third = rate[0][0] + 0.5 * divergence - divergence / 3.0;
    let other = rate[1][1] + 0.5 * divergence - divergence / 3.0;
    assert!((third + other).abs() > 0.1, "with a third it is not traceless");
}

/// The printed derivative of a tensor that is carried with the medium as two vectors are, X = F Fᵀ, vanishes for a = −1: that is the upper-convected one, and
/// a = 1 the lower-convected one, of X = F⁻ᵀ F⁻¹. The paper says the opposite.
#[test]
fn the_printed_slip_parameter_has_the_other_sign() {
    type Matrix = [[f64; 2]; 2];
    let product = |a: Matrix, b: Matrix| -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..2).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let transposed = |a: Matrix| -> Matrix { std::array::from_fn(|i| std::array::from_fn(|j| a[j][i])) };
    let sum = |a: Matrix, b: Matrix, factor: f64| -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
    };
    // ∂_j v_i, and its symmetric part and vorticity as printed.
    let l = [[0.3, -0.8], [0.5, 0.2]];
    let strain = sum(l, transposed(l), 1.0).map(|row| row.map(|x| 0.5 * x));
    let vorticity = sum(transposed(l), l, -1.0).map(|row| row.map(|x| 0.5 * x));
    let printed = |rate: Matrix, x: Matrix, a: f64| {
        let turned = sum(rate, sum(product(vorticity, x), product(x, vorticity), -1.0), 1.0);
        sum(turned, sum(product(strain, x), product(x, strain), 1.0), a)
    };
    let f = [[1.1, 0.4], [-0.2, 0.9]];
    let carried = product(f, transposed(f));
    let rate = sum(product(l, carried), product(carried, transposed(l)), 1.0);
    assert_near(printed(rate, carried, -1.0), [[0.0; 2]; 2], 1e-12);
    let determinant = carried[0][0] * carried[1][1] - carried[0][1] * carried[1][0];
    let inverse = [
        [carried[1][1] / determinant, -carried[0][1] / determinant],
        [-carried[1][0] / determinant, carried[0][0] / determinant],
    ];
    let rate = sum(product(transposed(l), inverse), product(inverse, l), 1.0).map(|row| row.map(|x| -x));
    assert_near(printed(rate, inverse, 1.0), [[0.0; 2]; 2], 1e-12);
}
