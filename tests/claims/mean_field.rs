//! The model on a honeycomb is what the mean-field theory says, which was derived without it.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector, circumcentre, honeycomb};
use voronudge_model::{BlockMatrix, HalfEdgeForces, Model, jacobian, stress};
use voronudge_spectrum::bloch_matrix;
use voronudge_theory::{MeanField, Orientation, Parameters, hexagon_perimeter, hexagon_side};

/// (P_0, α): solid, solid with waves, just below the limit of stability, beyond it.
const CASES: [(f64, f64); 6] = [(3.0, 0.0), (3.0, 0.3), (3.5, -0.2), (3.7, 1.0), (3.72, 0.01), (4.0, 2.9)];

fn theory(preferred_perimeter: f64, chirality: f64) -> MeanField {
    MeanField::new(Parameters { preferred_perimeter, chirality, ..Parameters::default() }).unwrap()
}

fn model(theory: &MeanField) -> Model<f64> {
    let p = theory.parameters();
    Model::chiral_voronoi(&voronudge_model::Parameters {
        area_elasticity: p.area_elasticity,
        perimeter_elasticity: p.perimeter_elasticity,
        preferred_perimeter: p.preferred_perimeter,
        preferred_area: 1.0,
        chirality: p.chirality,
    })
}

/// A periodic honeycomb of unit cells, stretched by factors along x and y.
struct Honeycomb {
    positions: Vec<Vector<f64>>,
    lengths: [f64; 2],
    tessellation: Tessellation,
}

impl Honeycomb {
    /// `rows` is even. Rows are lines of neighbours.
    fn new(columns: usize, rows: usize, orientation: Orientation, stretch: [f64; 2]) -> Self {
        let (mut positions, mut lengths) = honeycomb(columns, rows);
        if orientation == Orientation::NeighbourAlongY {
            // Turned by a quarter.
            positions.iter_mut().for_each(|r| *r = Vector::new(-r.y, r.x));
            lengths.reverse();
        }
        positions.iter_mut().for_each(|r| *r = Vector::new(r.x * stretch[0], r.y * stretch[1]));
        let lengths = [lengths[0] * stretch[0], lengths[1] * stretch[1]];
        let domain = Domain::Periodic(PeriodicBox::new(lengths).unwrap());
        Self { tessellation: Tessellation::new(&positions, domain).unwrap(), positions, lengths }
    }

    fn stress(&self, theory: &MeanField) -> [[f64; 2]; 2] {
        stress(&self.tessellation, &self.positions, &model(theory), |_| true)
    }

    /// Real and imaginary part of `−Σ_j J_{ij} exp(i q·(r_j − r_i))` by the nearest images.
    fn transform(&self, matrix: &BlockMatrix, cell: usize, q: Vector<f64>) -> [[[f64; 2]; 2]; 2] {
        bloch_matrix(&self.tessellation, &self.positions, matrix, cell, q.into())
    }
}

fn largest<'a>(entries: impl IntoIterator<Item = &'a [f64; 2]>) -> f64 {
    entries.into_iter().flatten().fold(0.0, |largest, entry| largest.max(entry.abs()))
}

/// Largest difference between the transform of the lattice Jacobian and D(q), relative to the largest entry of D(q), over
/// 50 random commensurate wave vectors in each orientation.
fn worst(theory: &MeanField, rng: &mut Pcg64) -> f64 {
    let mut worst = 0.0_f64;
    for orientation in Orientation::ALL {
        let lattice = Honeycomb::new(10, 12, orientation, [1.0; 2]);
        let matrix = jacobian(&lattice.tessellation, &lattice.positions, &model(theory));
        for _ in 0..50 {
            // Not (0, 0): within less than a zone, no other of these is a reciprocal vector.
            let mut index = [0, 0];
            while index == [0, 0] {
                index = [rng.random_range(-4..=4), rng.random_range(-4..=4)];
            }
            let component = |axis: usize| TAU * f64::from(index[axis]) / lattice.lengths[axis];
            let q = [component(0), component(1)];
            let expected = theory.dynamical_matrix(q, orientation).unwrap();
            let cell = rng.random_range(0..lattice.positions.len());
            let [mut real, imaginary] = lattice.transform(&matrix, cell, Vector::from(q));
            for (real, expected) in real.iter_mut().flatten().zip(expected.iter().flatten()) {
                *real -= expected;
            }
            worst = worst.max(largest(real.iter().chain(&imaginary)) / largest(&expected));
        }
    }
    worst
}

#[test]
fn the_lattice_jacobian_is_the_dynamical_matrix() {
    let mut rng = Pcg64::seed_from_u64(7);
    for (p_0, alpha) in CASES {
        let error = worst(&theory(p_0, alpha), &mut rng);
        assert!(error < 1e-12, "({p_0}, {alpha}): {error:.1e}");
    }
}

#[test]
fn so_it_is_with_area_elasticity() {
    let mut rng = Pcg64::seed_from_u64(8);
    for (p_0, alpha) in CASES {
        let theory = MeanField::new(Parameters {
            area_elasticity: 0.7,
            perimeter_elasticity: 1.3,
            preferred_perimeter: p_0,
            chirality: alpha,
        })
        .unwrap();
        let error = worst(&theory, &mut rng);
        assert!(error < 1e-12, "({p_0}, {alpha}): {error:.1e}");
    }
}

#[test]
fn the_stress_of_the_lattice_is_the_prestress() {
    for orientation in Orientation::ALL {
        let lattice = Honeycomb::new(6, 6, orientation, [1.0; 2]);
        for (p_0, alpha) in CASES {
            let theory = theory(p_0, alpha);
            let (found, expected) = (lattice.stress(&theory), theory.prestress());
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-11, "{found} {expected}");
            }
        }
    }
}

/// Central differences of the stress under dilation and pure shear.
#[test]
fn the_stress_changes_by_the_moduli() {
    let e = 1e-4;
    for orientation in Orientation::ALL {
        let strained = |x: f64, y: f64| Honeycomb::new(6, 6, orientation, [1.0 + x * e, 1.0 + y * e]);
        let [dilated, compressed] = [strained(1.0, 1.0), strained(-1.0, -1.0)];
        let [sheared, back] = [strained(1.0, -1.0), strained(-1.0, 1.0)];
        for (p_0, alpha) in CASES {
            for area_elasticity in [0.0, 0.4] {
                let theory =
                    MeanField::new(Parameters { area_elasticity, ..theory(p_0, alpha).parameters() });
                let theory = theory.unwrap();
                // ∇·u and ∂_x u_x − ∂_y u_y are both ±2e.
                let slope = |plus: &Honeycomb, minus: &Honeycomb| {
                    let (plus, minus) = (plus.stress(&theory), minus.stress(&theory));
                    move |row: usize, column: usize| (plus[row][column] - minus[row][column]) / (4.0 * e)
                };
                let (by_area, by_shear) = (slope(&dilated, &compressed), slope(&sheared, &back));
                let expected = theory.moduli();
                let found = [
                    (0.5 * (by_area(0, 0) + by_area(1, 1)), expected.bulk),
                    (0.5 * (by_area(1, 0) - by_area(0, 1)), expected.odd_bulk),
                    (0.5 * (by_shear(0, 0) - by_shear(1, 1)), expected.shear),
                    (-0.5 * (by_shear(0, 1) + by_shear(1, 0)), expected.odd_shear),
                    // Dilation shears nothing; pure shear neither dilates nor turns.
                    (by_area(0, 0) - by_area(1, 1), 0.0),
                    (by_area(0, 1) + by_area(1, 0), 0.0),
                    (by_shear(0, 0) + by_shear(1, 1), 0.0),
                    (by_shear(0, 1) - by_shear(1, 0), 0.0),
                ];
                for (which, (found, expected)) in found.into_iter().enumerate() {
                    assert!((found - expected).abs() < 1e-6, "{which}, ({p_0}, {alpha}): {found} {expected}");
                }
            }
        }
    }
}

/// Below the limit that the theory finds for all wave vectors every mode decays; between it and P_MF one grows.
#[test]
fn a_little_chirality_destabilises_before_the_critical_mode() {
    let orientation = Orientation::NeighbourAlongX;
    let lattice = Honeycomb::new(24, 24, orientation, [1.0; 2]);
    let (alpha, p_0) = (0.01, 0.9995 * hexagon_perimeter());
    assert!(theory(p_0, alpha).stability_limit(24) < p_0);
    let theory = theory(p_0, alpha);
    let mode = theory.slowest_mode(orientation, 24);
    let matrix = jacobian(&lattice.tessellation, &lattice.positions, &model(&theory));
    // The determinant of the transform of the lattice Jacobian: negative, so that one of two real rates is.
    let [[[xx, xy], [yx, yy]], imaginary] = lattice.transform(&matrix, 5, Vector::from(mode.q));
    assert!(largest(&imaginary) < 1e-11);
    assert!(xx * yy - xy * yx < -1e-3 && mode.rate.real < 0.0, "{mode:?}");
    let critical = theory.decay_rates(theory.critical_wave_vector(orientation), orientation).unwrap();
    assert!(critical[0].real > 0.0);
}

/// What the missing neighbours no longer exert on a row of cells along an edge, and what holds the row.
#[test]
fn an_edge_row_feels_the_force_and_the_stiffness_of_the_estimate() {
    let lattice = Honeycomb::new(8, 12, Orientation::NeighbourAlongX, [1.0; 2]);
    let (cell, tessellation) = (40, &lattice.tessellation);
    let shift =
        |other: usize| tessellation.domain().shortest(lattice.positions[other] - lattice.positions[cell]);
    for (p_0, alpha) in CASES {
        let (chiral, achiral) = (theory(p_0, alpha), theory(p_0, 0.0));
        let from_below = |theory: &MeanField| -> f64 {
            let forces = HalfEdgeForces::of(tessellation, &lattice.positions, &model(theory));
            let below = tessellation.ring(cell).filter(|&h| shift(tessellation.neighbour(h)).y < -0.1);
            below.map(|h| forces.on_neighbour(tessellation.twin(h)).x).sum()
        };
        let force = from_below(&chiral) - from_below(&achiral);
        assert!((force.abs() - chiral.edge_row().force).abs() < 1e-12, "{force}");
        let matrix = jacobian(tessellation, &lattice.positions, &model(&chiral));
        let bulk = matrix.row(cell).filter(|(column, _)| shift(*column).y > 0.1);
        let stiffness: f64 = bulk.map(|(_, block)| block[0]).sum();
        assert!((stiffness - chiral.edge_row().stiffness).abs() < 1e-12, "{stiffness}");
    }
}

/// A vertex of the honeycomb follows one of its cells by (2/3) b̂ b̂ᵀ with the unit vector from the cell to it, that is by 2/(3d²) b bᵀ; the paper prints (2/3) b bᵀ
/// where it inserts this.
#[test]
fn a_vertex_follows_a_cell_by_two_thirds() {
    let d = hexagon_side();
    // Two neighbours of a cell at the origin, 60° apart.
    let [a, c] = [30f64, 90.0].map(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vector::new(cos, sin) * (3f64.sqrt() * d)
    });
    let b = circumcentre(a, c);
    assert!((b.norm() - d).abs() < 1e-12);
    let step = 1e-6;
    for axis in 0..2 {
        let mut moved = Vector::zeros();
        moved[axis] = step;
        let place = |by: Vector<f64>| circumcentre(a - by, c - by) + by;
        let found = (place(moved) - place(-moved)) / (2.0 * step);
        let expected = b * (2.0 / (3.0 * d * d) * b[axis]);
        assert!((found - expected).norm() < 1e-8, "{found} {expected}");
    }
}
