//! The modes of the simulated model on a honeycomb are those of the mean-field theory, with their exceptional points.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector, areas};
use voronudge_model::{Model, Parameters, velocities};
use voronudge_spectrum::{Arrangement, Honeycomb, LinearProblem, Request, Selection, modes};
use voronudge_theory::{MeanField, Orientation, hexagon_perimeter};

/// The lattices of the model and of the theory that lie alike.
const LATTICES: [(Arrangement, Orientation); 2] = [
    (Arrangement::RowsAlongX, Orientation::NeighbourAlongX),
    (Arrangement::RowsAlongY, Orientation::NeighbourAlongY),
];

fn model(preferred_perimeter: f64, chirality: f64) -> Model<f64> {
    let area_elasticity = 0.0;
    Model::chiral_voronoi(&Parameters {
        area_elasticity,
        preferred_perimeter,
        chirality,
        ..Parameters::default()
    })
}

fn theory(preferred_perimeter: f64, chirality: f64) -> MeanField {
    let parameters = voronudge_theory::Parameters {
        preferred_perimeter,
        chirality,
        ..voronudge_theory::Parameters::default()
    };
    MeanField::new(parameters).unwrap()
}

/// Entries of D(q) from the model's Jacobian; they are real.
fn exact(lattice: &Honeycomb, model: &Model<f64>, q: [f64; 2]) -> [[f64; 2]; 2] {
    let [real, imaginary] = lattice.dynamical_matrix(&lattice.jacobian(model), 0, q);
    let largest = real.iter().flatten().fold(1.0_f64, |most, x| most.max(x.abs()));
    assert!(imaginary.iter().flatten().all(|x| x.abs() < 1e-11 * largest));
    real
}

/// Any wave vector, not only those that fit into the box, and any parameters.
#[test]
fn dispersion_agrees_at_random_wave_vectors_and_parameters() {
    let mut rng = Pcg64::seed_from_u64(11);
    for (arrangement, orientation) in LATTICES {
        let lattice = Honeycomb::new(6, 8, arrangement).unwrap();
        for _ in 0..50 {
            let (p_0, alpha) = (rng.random_range(2.5..4.5), rng.random_range(-3.0..3.0));
            let q = [rng.random_range(-4.0..4.0), rng.random_range(-4.0..4.0)];
            let found = exact(&lattice, &model(p_0, alpha), q);
            let expected = theory(p_0, alpha).dynamical_matrix(q, orientation).unwrap();
            let largest = expected.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-11 * largest, "({p_0}, {alpha}) {q:?}");
            }
        }
    }
}

/// All modes of a periodic honeycomb: at every wave vector that fits, the two of the theory.
#[test]
fn the_modes_of_a_honeycomb_are_those_of_the_theory() {
    let [columns, rows] = [6, 8];
    for (arrangement, orientation) in LATTICES {
        for (p_0, alpha) in [(3.4, 0.25), (3.0, 0.0), (3.9, -1.0)] {
            let lattice = Honeycomb::new(columns, rows, arrangement).unwrap();
            let problem =
                LinearProblem::new(lattice.tessellation(), lattice.positions(), &model(p_0, alpha), |_| true)
                    .unwrap();
            let found = modes(&problem, &Request::new(Selection::All), &mut |_, _, _| {}).unwrap();
            let mut left: Vec<_> = found.modes.iter().map(|mode| mode.value).collect();
            let mut squares = 0.0;
            // The box holds two cells of the lattice at each of its rectangular cells: m up to columns, n up to rows.
            let [x, y] = lattice.lengths();
            let [m_x, m_y] = match arrangement {
                Arrangement::RowsAlongX => [columns, rows],
                Arrangement::RowsAlongY => [rows, columns],
            };
            for (m, n) in (0..m_x).flat_map(|m| (0..m_y).map(move |n| (m, n))) {
                let q = [TAU * m as f64 / x, TAU * n as f64 / y];
                for rate in theory(p_0, alpha).decay_rates(q, orientation).unwrap() {
                    let distance = |k: &usize| (left[*k].re + rate.real).hypot(left[*k].im + rate.imaginary);
                    let nearest = (0..left.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
                    // Values that coalesce are known to the root of rounding.
                    assert!(distance(&nearest) < 1e-6, "({p_0}, {alpha}) {q:?} {rate:?}");
                    left.swap_remove(nearest);
                    squares += rate.imaginary.powi(2);
                }
            }
            assert!(left.is_empty());
            let mean = squares / (2.0 * (columns * rows) as f64);
            assert!((found.mean_square_frequency().unwrap() - mean).abs() < 1e-6);
        }
    }
}

/// Cells displaced by u cos(q·r) move with −D u cos(q·r): the rates of D are decay rates, `iω u = D u` for exp(−iωt).
#[test]
fn a_wave_moves_as_the_theory_says() {
    for (arrangement, orientation) in LATTICES {
        let lattice = Honeycomb::new(6, 8, arrangement).unwrap();
        let (p_0, alpha, e) = (3.4, 0.4, 1e-6);
        let q = [TAU / lattice.lengths()[0], 2.0 * TAU / lattice.lengths()[1]];
        let d = theory(p_0, alpha).dynamical_matrix(q, orientation).unwrap();
        let u = Vector::new(0.6, -0.8);
        let cosine = |r: &Vector<f64>| (q[0] * r.x + q[1] * r.y).cos();
        let moved = |sign: f64| {
            let positions: Vec<_> =
                lattice.positions().iter().map(|r| r + u * (sign * e * cosine(r))).collect();
            let tessellation = Tessellation::new(&positions, lattice.tessellation().domain()).unwrap();
            velocities(&tessellation, &positions, &model(p_0, alpha))
        };
        for ((r, a), b) in lattice.positions().iter().zip(moved(1.0)).zip(moved(-1.0)) {
            let expected =
                Vector::new(d[0][0] * u.x + d[0][1] * u.y, d[1][0] * u.x + d[1][1] * u.y) * -cosine(r);
            assert!(((a - b) / (2.0 * e) - expected).norm() < 1e-6, "{a} {b} {expected}");
        }
    }
}

/// Cells displaced by u = (g x, 0): the density falls from ρ_0 to ρ_0 (1 − ∇·u).
#[test]
fn a_dilation_lowers_the_density() {
    let lattice = Honeycomb::new(6, 8, Arrangement::RowsAlongX).unwrap();
    let g = 1e-4;
    let positions: Vec<_> = lattice.positions().iter().map(|r| Vector::new((1.0 + g) * r.x, r.y)).collect();
    let [x, y] = lattice.lengths();
    let domain = Domain::Periodic(PeriodicBox::new([(1.0 + g) * x, y]).unwrap());
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    for area in areas(&tessellation, &positions) {
        assert!((1.0 / area - (1.0 - g)).abs() < 2.0 * g * g);
    }
}

/// `¼ (D_xx − D_yy)² + D_xy D_yx`: negative where the modes oscillate.
fn discriminant([[xx, xy], [yx, yy]]: [[f64; 2]; 2]) -> f64 {
    0.25 * (xx - yy).powi(2) + xy * yx
}

/// The positive chirality at which the modes of the simulated model begin to oscillate, by bisection.
fn onset(lattice: &Honeycomb, p_0: f64, q: [f64; 2]) -> f64 {
    let (mut low, mut high) = (0.0, 4.0);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        let oscillates = discriminant(exact(lattice, &model(p_0, middle), q)) < 0.0;
        if oscillates { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Overlap of the two unit eigenvectors of a real matrix with real eigenvalues.
fn overlap(matrix: [[f64; 2]; 2]) -> f64 {
    let [[xx, xy], [_, yy]] = matrix;
    let root = discriminant(matrix).max(0.0).sqrt();
    let vector = |sign: f64| [xy, 0.5 * (yy - xx) + sign * root];
    let ([a, b], [c, d]) = (vector(1.0), vector(-1.0));
    (a * c + b * d).abs() / (a.hypot(b) * c.hypot(d))
}

#[test]
fn waves_at_the_critical_wave_vector_begin_on_the_exceptional_line() {
    for (arrangement, orientation) in LATTICES {
        let lattice = Honeycomb::new(6, 8, arrangement).unwrap();
        for p_0 in [2.8, 3.2, 3.5, 3.65, 3.9] {
            let q = theory(p_0, 0.0).critical_wave_vector(orientation);
            let found = onset(&lattice, p_0, q);
            let expected = (hexagon_perimeter() - p_0).abs() / (3f64.sqrt() * hexagon_perimeter());
            assert!((found - expected).abs() < 1e-6, "{p_0}: {found} {expected}");
            // There the two vectors are one.
            assert!(overlap(exact(&lattice, &model(p_0, found - 1e-9), q)) > 1.0 - 1e-6);
            assert!(overlap(exact(&lattice, &model(p_0, 0.5 * found), q)) < 0.999);
        }
    }
}

#[test]
fn waves_elsewhere_begin_where_the_general_condition_says() {
    let mut rng = Pcg64::seed_from_u64(12);
    let mut compared = 0;
    for (arrangement, orientation) in LATTICES {
        let lattice = Honeycomb::new(6, 8, arrangement).unwrap();
        for _ in 0..15 {
            let (p_0, q) =
                (rng.random_range(2.8..3.7), [rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0)]);
            let Some([_, expected]) = theory(p_0, 0.0).exceptional_chiralities(q, orientation).unwrap()
            else {
                continue;
            };
            if expected < 3.9 {
                let found = onset(&lattice, p_0, q);
                assert!((found - expected).abs() < 1e-6, "{p_0} {q:?}: {found} {expected}");
                compared += 1;
            }
        }
    }
    assert!(compared > 20, "{compared}");
}
