//! Limits that must hold whatever the parameters.

#![allow(clippy::unwrap_used, reason = "a test may fail anywhere")]

use voronudge_theory::{
    Eigenvalue, Error, MeanField, Moduli, Orientation, Parameters, Phase, SymmetryPoint, hexagon_perimeter,
    hexagon_side, symmetry_path,
};

/// (P_0, α) in the solid, across the exceptional line, and beyond the limit of stability.
const CASES: [(f64, f64); 6] = [(3.0, 0.0), (3.0, 0.3), (3.5, -0.2), (3.7, 1.0), (3.9, 0.4), (4.2, -2.0)];

fn theory(preferred_perimeter: f64, chirality: f64) -> MeanField {
    MeanField::new(Parameters { preferred_perimeter, chirality, ..Parameters::default() }).unwrap()
}

fn matrix(theory: &MeanField, q: [f64; 2], orientation: Orientation) -> [[f64; 2]; 2] {
    theory.dynamical_matrix(q, orientation).unwrap()
}

/// `R(−φ) D R(φ)`: components along a direction φ and a quarter turn ahead.
fn along(m: [[f64; 2]; 2], angle: f64) -> [[f64; 2]; 2] {
    let axes = [[angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]];
    let project =
        |a: [f64; 2], b: [f64; 2]| (0..2).map(|i| a[i] * (m[i][0] * b[0] + m[i][1] * b[1])).sum::<f64>();
    [
        [project(axes[0], axes[0]), project(axes[0], axes[1])],
        [project(axes[1], axes[0]), project(axes[1], axes[1])],
    ]
}

fn difference(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Irregular points of the plane of wave vectors, without a generator of random numbers.
fn scattered(count: usize) -> impl Iterator<Item = [f64; 2]> {
    (1..=count).map(|k| [8.0 * (1.7 * k as f64).sin(), 8.0 * (2.9 * k as f64 + 0.4).cos()])
}

#[test]
fn along_b_it_is_the_matrix_in_closed_form() {
    let d = hexagon_side();
    for (p_0, alpha) in CASES {
        for q in [0.01, 0.4, 1.1, 2.5, 4.0] {
            let (cos, sin) = ((1.5 * d * q).cos(), (0.75 * d * q).sin());
            let scale = 4.0 * sin * sin / d;
            let expected = [
                [scale * ((4.0 + 2.0 * cos) * d - p_0 / 3.0), scale * -2.0 * alpha * d],
                [scale * (4.0 - 2.0 * cos) * alpha * d, scale * (6.0 * d - p_0)],
            ];
            // Six equivalent directions in each orientation; in the rows-along-x lattice y is one of them.
            for turn in 0..6 {
                let sixth = f64::from(turn) * std::f64::consts::FRAC_PI_3;
                for (orientation, first) in [
                    (Orientation::NeighbourAlongY, 0.0),
                    (Orientation::NeighbourAlongX, std::f64::consts::FRAC_PI_2),
                ] {
                    let angle = first + sixth;
                    let found = matrix(&theory(p_0, alpha), [q * angle.cos(), q * angle.sin()], orientation);
                    assert!(difference(along(found, angle), expected) < 1e-13, "{found:?} {expected:?}");
                }
            }
        }
    }
}

/// `D = q² [[B + μ, Kᵒ], [A − Kᵒ, μ]] + O(q⁴)` in every direction: extrapolated to q = 0 in q².
#[test]
fn long_waves_are_isotropic_and_have_the_moduli() {
    for (p_0, alpha) in CASES {
        for area_elasticity in [0.0, 0.4] {
            let theory = MeanField::new(Parameters {
                area_elasticity,
                perimeter_elasticity: 1.3,
                preferred_perimeter: p_0,
                chirality: alpha,
            })
            .unwrap();
            let Moduli { bulk, odd_bulk, shear, odd_shear } = theory.moduli();
            let expected = [[bulk + shear, odd_shear], [odd_bulk - odd_shear, shear]];
            for step in 0..24 {
                let angle = 0.1 + 0.27 * f64::from(step);
                let scaled = |q: f64| {
                    let m = matrix(&theory, [q * angle.cos(), q * angle.sin()], Orientation::NeighbourAlongY);
                    along(m, angle).map(|row| row.map(|entry| entry / (q * q)))
                };
                let (near, far) = (scaled(5e-3), scaled(1e-2));
                let limit = [0, 1].map(|i| [0, 1].map(|j| (4.0 * near[i][j] - far[i][j]) / 3.0));
                // What is left is of order q⁴.
                assert!(difference(limit, expected) < 1e-7, "{limit:?} {expected:?}");
            }
        }
    }
}

#[test]
fn it_is_periodic_and_even_and_vanishes_at_the_centre() {
    for orientation in Orientation::ALL {
        let [g, h] = orientation.reciprocal();
        for (p_0, alpha) in CASES {
            let theory = theory(p_0, alpha);
            assert_eq!(matrix(&theory, [0.0; 2], orientation), [[0.0; 2]; 2]);
            for q in scattered(20) {
                let here = matrix(&theory, q, orientation);
                for (m, n) in [(1.0, 0.0), (0.0, 1.0), (-2.0, 3.0)] {
                    let there = [0, 1].map(|axis| q[axis] + m * g[axis] + n * h[axis]);
                    assert!(difference(matrix(&theory, there, orientation), here) < 1e-11);
                }
                assert!(difference(matrix(&theory, q.map(|c| -c), orientation), here) < 1e-13);
            }
        }
    }
}

/// Without chirality forces derive from an energy; a mirror turns α into −α; the trace does not know α.
#[test]
fn symmetries_of_the_matrix() {
    for orientation in Orientation::ALL {
        for q in scattered(40) {
            for (p_0, alpha) in CASES {
                let [[xx, xy], [yx, yy]] = matrix(&theory(p_0, 0.0), q, orientation);
                assert!((xy - yx).abs() < 1e-13);
                let chiral = matrix(&theory(p_0, alpha), q, orientation);
                assert!((chiral[0][0] + chiral[1][1] - xx - yy).abs() < 1e-12);
                let [[mxx, mxy], [myx, myy]] = matrix(&theory(p_0, -alpha), [q[0], -q[1]], orientation);
                assert!(difference([[mxx, -mxy], [-myx, myy]], chiral) < 1e-12);
            }
        }
    }
}

#[test]
fn the_lattices_differ_by_a_quarter_turn() {
    for q in scattered(20) {
        let theory = theory(3.4, 0.7);
        let [[xx, xy], [yx, yy]] = matrix(&theory, q, Orientation::NeighbourAlongY);
        let turned = matrix(&theory, [-q[1], q[0]], Orientation::NeighbourAlongX);
        assert!(difference(turned, [[yy, -yx], [-xy, xx]]) < 1e-12);
    }
}

#[test]
fn the_critical_mode_has_the_rates_in_closed_form() {
    for (p_0, alpha) in CASES {
        let s = 1.0 - p_0 / hexagon_perimeter();
        let square = s * s - 3.0 * alpha * alpha;
        for (area_elasticity, orientation) in [(0.0, Orientation::ALL[0]), (0.6, Orientation::ALL[1])] {
            let parameters = Parameters {
                area_elasticity,
                preferred_perimeter: p_0,
                chirality: alpha,
                ..Parameters::default()
            };
            let theory = MeanField::new(parameters).unwrap();
            let q = theory.critical_wave_vector(orientation);
            let [slow, fast] = theory.decay_rates(q, orientation).unwrap();
            let root = 8.0 * square.abs().sqrt();
            let (spread, frequency) = if square > 0.0 { (root, 0.0) } else { (0.0, root) };
            assert!((slow.real - 16.0 * s + spread).abs() < 1e-11, "{slow:?}");
            assert!((fast.real - 16.0 * s - spread).abs() < 1e-11, "{fast:?}");
            assert!((slow.imaginary - frequency).abs() < 1e-11, "{slow:?}");
            let phase = match (s > 0.0, frequency > 0.0) {
                (false, _) => Phase::Unstable,
                (true, true) => Phase::OddElasticSolid,
                (true, false) => Phase::Solid,
            };
            assert_eq!(theory.phase(), phase);
        }
    }
}

/// Bisection for the chirality at which the eigenvalues at q become complex.
fn onset(p_0: f64, q: [f64; 2]) -> f64 {
    let waves =
        |alpha| theory(p_0, alpha).decay_rates(q, Orientation::NeighbourAlongY).unwrap()[0].imaginary > 0.0;
    let (mut low, mut high) = (0.0, 5.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if waves(middle) { high = middle } else { low = middle }
    }
    high
}

#[test]
fn eigenvalues_coalesce_on_the_exceptional_line() {
    let d = hexagon_side();
    for p_0 in [2.0, 3.0, 3.5, 3.7, 3.9] {
        let theory = theory(p_0, 0.0);
        let q = theory.critical_wave_vector(Orientation::NeighbourAlongY);
        let line = theory.exceptional_chirality();
        assert!(
            (line - (hexagon_perimeter() - p_0).abs() / (3f64.sqrt() * hexagon_perimeter())).abs() < 1e-15
        );
        assert!((onset(p_0, q) - line).abs() < 1e-6, "{} {line}", onset(p_0, q));
        let [low, high] = theory.exceptional_chiralities(q, Orientation::NeighbourAlongY).unwrap().unwrap();
        assert!((high - line).abs() < 1e-12 && (low + line).abs() < 1e-12);
        // Other wave vectors along b: |P_0 + 3d cos θ − 3d| = 6 |α| d √(2 − cos θ) with θ = 3dq/2.
        for q in [0.3, 1.0, 2.0, 3.0] {
            let cos = (1.5 * d * q).cos();
            let line = (p_0 + 3.0 * d * cos - 3.0 * d).abs() / (6.0 * d * (2.0 - cos).sqrt());
            let roots =
                theory.exceptional_chiralities([q, 0.0], Orientation::NeighbourAlongY).unwrap().unwrap();
            assert!((roots[1] - line).abs() < 1e-11 && (roots[0] + line).abs() < 1e-11);
            assert!((onset(p_0, [q, 0.0]) - line).abs() < 1e-6);
        }
    }
}

/// In general directions the two exceptional points are not opposite, and they are where the eigenvalues say.
#[test]
fn exceptional_points_at_any_wave_vector() {
    let mut skewed = 0;
    for q in scattered(60) {
        let base = theory(3.4, 0.0);
        let [low, high] = base.exceptional_chiralities(q, Orientation::NeighbourAlongX).unwrap().unwrap();
        skewed += usize::from((low + high).abs() > 1e-3 * (high - low));
        let frequency =
            |alpha| theory(3.4, alpha).decay_rates(q, Orientation::NeighbourAlongX).unwrap()[0].imaginary;
        let step = 1e-6 * (high - low);
        // Within a relative step of the roots, and where α = 0 has real rates.
        assert!(frequency(low + step) == 0.0 && frequency(high - step) == 0.0, "{low} {high}");
        assert!(frequency(low - step) > 0.0 && frequency(high + step) > 0.0, "{low} {high}");
        assert!(low <= 0.0 && high >= 0.0);
    }
    assert!(skewed > 10, "{skewed}");
    assert_eq!(theory(3.4, 0.0).exceptional_chiralities([0.0; 2], Orientation::ALL[0]).unwrap(), None);
}

/// At K the lattice turned by 120° is itself: D commutes with the turn, so it is a multiple of one plus a rotation.
#[test]
fn at_k_any_chirality_makes_waves() {
    for (p_0, alpha) in CASES {
        for orientation in Orientation::ALL {
            let q = orientation.wave_vector(SymmetryPoint::K);
            let [[xx, xy], [yx, yy]] = matrix(&theory(p_0, alpha), q, orientation);
            assert!((xx - yy).abs() < 1e-12 && (xy + yx).abs() < 1e-12);
            let [Eigenvalue { imaginary, .. }, _] = theory(p_0, alpha).decay_rates(q, orientation).unwrap();
            assert_eq!(imaginary > 0.0, alpha != 0.0);
        }
    }
}

#[test]
fn the_honeycomb_is_stable_up_to_its_limit() {
    for alpha in [0.0, 0.01, 0.1, 0.5, 1.0, 3.0, 10.0] {
        let limit = theory(3.0, alpha).stability_limit(60);
        let orientation = Orientation::NeighbourAlongY;
        for p_0 in [-5.0, 2.0, 3.0, 3.5, limit - 1e-6] {
            assert!(theory(p_0, alpha).slowest_mode(orientation, 60).rate.real > 0.0, "{p_0} {alpha}");
        }
        let beyond = theory(limit + 1e-6, alpha).slowest_mode(orientation, 60);
        assert!(beyond.rate.real < 0.0, "{alpha} {beyond:?}");
        // The mode at q* itself.
        let q = theory(3.0, alpha).critical_wave_vector(orientation);
        let own = theory(3.0, alpha).stability_limit_at(q, orientation).unwrap().unwrap();
        assert!((own - hexagon_perimeter()).abs() < 1e-12);
    }
    assert_eq!(theory(3.0, 0.4).stability_limit_at([0.0; 2], Orientation::ALL[0]).unwrap(), None);
}

/// At P_MF and α = 0 one mode of every wave vector is marginal. A little chirality makes some of them unstable before the
/// one at q*; more of it stabilises them again.
#[test]
fn a_little_chirality_destabilises_a_little_earlier() {
    let early = |alpha| 1.0 - theory(3.0, alpha).stability_limit(120) / hexagon_perimeter();
    assert!(early(0.0).abs() < 1e-12);
    for alpha in [0.003, 0.01, 0.02, 0.03] {
        assert!(early(alpha) > 4e-4 && early(alpha) < 1e-3, "{alpha} {}", early(alpha));
        assert!((early(alpha) - early(-alpha)).abs() < 1e-10);
    }
    for alpha in [0.05, 0.1, 1.0, 3.0] {
        assert!(early(alpha).abs() < 1e-12, "{alpha} {}", early(alpha));
    }
}

#[test]
fn flow_and_edge_in_closed_form() {
    let a = 1.0 / (2.0 * (2.0 * 3f64.sqrt()).sqrt());
    for (p_0, alpha) in CASES {
        let theory = theory(p_0, alpha);
        assert!((theory.transverse_flow().unwrap() - alpha / (3.0 - a * p_0)).abs() < 1e-14);
        let moduli = theory.moduli();
        assert!((moduli.odd_shear + 3f64.sqrt() * alpha).abs() < 1e-14 && moduli.odd_bulk == 0.0);
        let row = theory.edge_row();
        if p_0 < hexagon_perimeter() {
            let slip = row.force / row.stiffness / (0.5 * 3f64.sqrt() * hexagon_side());
            assert!((slip - alpha.abs() / theory.edge_slip_chirality()).abs() < 1e-12);
            assert!((theory.edge_current_threshold() - 0.5 * theory.edge_slip_chirality()).abs() < 1e-15);
        } else {
            assert_eq!(theory.edge_current_threshold(), 0.0);
        }
    }
    assert_eq!(theory(12.0, 0.0).transverse_flow(), None);
}

#[test]
fn the_path_meets_all_points() {
    let theory = theory(3.5, 0.4);
    let path = symmetry_path(Orientation::NeighbourAlongX, 20);
    let rates: Vec<_> =
        path.iter().map(|p| theory.decay_rates(p.q, Orientation::NeighbourAlongX).unwrap()[1].real).collect();
    // Continuous: no step larger than the largest slope allows.
    assert!(rates.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 2.0), "{rates:?}");
    assert!(rates[0].abs() < 1e-12 && rates[60].abs() < 1e-12);
}

#[test]
fn senseless_input_is_refused() {
    let with = |p: Parameters| MeanField::new(p).unwrap_err();
    let base = Parameters::default();
    let not_finite = with(Parameters { chirality: f64::INFINITY, ..base });
    assert_eq!(not_finite, Error::Parameter { name: "α", value: f64::INFINITY });
    assert_eq!(not_finite.to_string(), "α is inf, not a finite number");
    assert_eq!(
        with(Parameters { perimeter_elasticity: 0.0, ..base }),
        Error::PerimeterElasticity { value: 0.0 }
    );
    assert!(matches!(
        MeanField::new(base).unwrap().decay_rates([f64::NAN, 0.0], Orientation::NeighbourAlongX),
        Err(Error::WaveVector { .. })
    ));
}

/// Nothing oscillates without chirality; far beyond every exceptional point ω² grows as α².
#[test]
fn the_mean_square_frequency_grows_as_the_square_of_the_chirality() {
    assert_eq!(theory(3.3, 0.0).mean_square_frequency(20), 0.0);
    let [one, two] = [50.0, 100.0].map(|alpha| theory(3.3, alpha).mean_square_frequency(20));
    assert!((two / one / 4.0 - 1.0).abs() < 0.01, "{one} {two}");
    let [left, right] = [0.7, -0.7].map(|alpha| theory(3.3, alpha).mean_square_frequency(20));
    assert!((left / right - 1.0).abs() < 1e-12 && left > 0.0);
}

/// Averaged over directions, D is that of any direction for long waves, and its trace and the difference off the diagonal are those of the average at any.
#[test]
fn averages_over_directions() {
    for (p_0, alpha) in CASES {
        let theory = theory(p_0, alpha);
        let Moduli { bulk, odd_bulk, shear, odd_shear } = theory.moduli();
        let long = theory.isotropic_dynamical_matrix(0.01).unwrap();
        let expected = [[bulk + shear, odd_shear], [odd_bulk - odd_shear, shear]];
        assert!(difference(long.map(|row| row.map(|entry| entry * 1e4)), expected) < 1e-3, "{long:?}");
        let (q, count) = (2.2, 720);
        let mean = theory.isotropic_dynamical_matrix(q).unwrap();
        let (mut trace, mut odd) = (0.0, 0.0);
        for step in 0..count {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(count);
            let own = matrix(&theory, [q * angle.cos(), q * angle.sin()], Orientation::NeighbourAlongY);
            trace += (own[0][0] + own[1][1]) / f64::from(count);
            odd += (own[0][1] - own[1][0]) / f64::from(count);
        }
        assert!(
            (mean[0][0] + mean[1][1] - trace).abs() < 1e-9 && (mean[0][1] - mean[1][0] - odd).abs() < 1e-9
        );
    }
    assert!(theory(3.0, 0.0).isotropic_dynamical_matrix(f64::NAN).is_err());
}
