//! The oracle and the model agree.

use super::{Constants, Oracle};
use nalgebra::{DMatrix, DVector, Vector2};
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, areas, perimeters};
use voronudge_model::{Model, Parameters, jacobian, stress, velocities};
use voronudge_simulate::{RandomPlacement, Simulation, generator, moduli};
use voronudge_spectrum::{LinearProblem, Request, Selection, modes};

/// Largest difference, relative to the largest entry.
fn difference(a: impl IntoIterator<Item = f64>, b: impl IntoIterator<Item = f64>) -> f64 {
    let (a, b): (Vec<_>, Vec<_>) = (a.into_iter().collect(), b.into_iter().collect());
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    a.iter().zip(&b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / scale
}

fn flat(vectors: &[Vector2<f64>]) -> impl Iterator<Item = f64> {
    vectors.iter().flat_map(|v| [v.x, v.y])
}

/// Compares everything for one tissue. Rounding grows with the inverse of the shortest side: 1e-10 is for sides above
/// a hundredth of the spacing.
fn compare(positions: &[Vector2<f64>], lengths: [f64; 2], constants: Constants) {
    let oracle = Oracle::new(positions, lengths);
    assert!(oracle.shortest_side() > 0.01, "the positions are not generic: {}", oracle.shortest_side());
    let expected = oracle.fields(&constants);
    let domain = Domain::Periodic(PeriodicBox::new(lengths).unwrap());
    let tessellation = Tessellation::new(positions, domain).unwrap();
    let model = Model::chiral_voronoi(&Parameters {
        area_elasticity: constants.area_elasticity,
        perimeter_elasticity: constants.perimeter_elasticity,
        preferred_perimeter: constants.preferred_perimeter,
        preferred_area: constants.preferred_area,
        chirality: constants.chirality,
    });
    assert!(difference(areas(&tessellation, positions), expected.areas) < 1e-10);
    assert!(difference(perimeters(&tessellation, positions), expected.perimeters) < 1e-10);
    let v = velocities(&tessellation, positions, &model);
    assert!(difference(flat(&v), flat(&expected.velocities)) < 1e-10);
    let sigma = stress(&tessellation, positions, &model, |_| true);
    assert!(difference(sigma.into_iter().flatten(), expected.stress.into_iter().flatten()) < 1e-10);
    let dense = jacobian(&tessellation, positions, &model).to_dense();
    let rows = oracle.jacobian(&constants).into_iter().flatten();
    assert!(difference(dense, rows) < 1e-10);
    let problem = LinearProblem::new(&tessellation, positions, &model, |_| true).unwrap();
    let found = modes(&problem, &Request::new(Selection::All), &mut |_, _, _| {}).unwrap();
    let scale = problem.largest_rate();
    let values = oracle.eigenvalues(&constants);
    assert_eq!(values.len(), found.modes.len());
    for [re, im] in values {
        let nearest = found.modes.iter().map(|mode| (mode.value.re - re).hypot(mode.value.im - im));
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-8 * scale);
    }
}

#[test]
fn the_model_agrees_on_random_tissues() {
    let constants = Constants {
        area_elasticity: 0.3,
        perimeter_elasticity: 1.4,
        preferred_perimeter: 3.6,
        preferred_area: 0.9,
        chirality: -1.7,
    };
    // Seeds whose tissues have no side shorter than the limit above.
    let mut compared = 0;
    for seed in 0..40 {
        let lengths = [4.5, 3.6];
        let cell_box = PeriodicBox::new(lengths).unwrap();
        let positions = RandomPlacement::new(16, cell_box).draw(&mut generator(seed)).unwrap();
        if Oracle::new(&positions, lengths).shortest_side() > 0.01 {
            compare(&positions, lengths, constants);
            compared += 1;
        }
    }
    assert!(compared > 4, "{compared}");
}

#[test]
fn the_model_agrees_on_the_fixture() {
    let set = crate::fixtures::reference::tissue().unwrap();
    compare(&set.positions, set.lengths, set.constants);
}

#[test]
fn the_recorded_fixture_is_what_its_seed_makes() {
    let set = crate::fixtures::reference::tissue().unwrap();
    let recorded = |name| {
        let path = crate::root().join("fixtures").join(crate::fixtures::reference::NAME).join(name);
        voronudge_io::read_reals(&path).unwrap().into_iter()
    };
    // Another machine may round the two hundred steps differently.
    assert!(difference(flat(&set.positions), recorded("positions.npy")) < 1e-9);
    let fields = Oracle::new(&set.positions, set.lengths).fields(&set.constants);
    assert!(difference(flat(&fields.velocities), recorded("velocities.npy")) < 1e-8);
}

/// `(σ_xx − σ_yy)/2` and `(σ_xy + σ_yx)/2` of a solid stretched along x by `exp(h/2)`, narrowed along y, and at rest again by Newton's
/// method.
fn shear_stress(rest: &[Vector2<f64>], lengths: [f64; 2], constants: &Constants, strain: f64) -> [f64; 2] {
    let factors = [0.5, -0.5].map(|half: f64| (half * strain).exp());
    let lengths = [0, 1].map(|k| lengths[k] * factors[k]);
    let mut positions: Vec<Vector2<f64>> =
        rest.iter().map(|r| Vector2::new(r.x * factors[0], r.y * factors[1])).collect();
    let n = positions.len();
    for _ in 0..4 {
        let oracle = Oracle::new(&positions, lengths);
        let rows = oracle.jacobian(constants);
        // Translations move nothing: they are given a rate.
        let matrix = DMatrix::from_fn(2 * n, 2 * n, |row, column| {
            rows[row][column] - if row % 2 == column % 2 { 1.0 / n as f64 } else { 0.0 }
        });
        let v = DVector::from_iterator(2 * n, flat(&oracle.fields(constants).velocities));
        let step = matrix.lu().solve(&v).unwrap();
        positions.iter_mut().enumerate().for_each(|(i, r)| *r -= Vector2::new(step[2 * i], step[2 * i + 1]));
    }
    let fields = Oracle::new(&positions, lengths).fields(constants);
    assert!(fields.velocities.iter().all(|v| v.norm() < 1e-12));
    let s = fields.stress;
    [0.5 * (s[0][0] - s[1][1]), 0.5 * (s[0][1] + s[1][0])]
}

/// Kᵒ of disordered solids, which is well below that of the honeycomb, is a property of the equations.
#[test]
fn shear_moduli_of_disordered_solids_agree() {
    let lengths = [5.0, 5.0];
    let constants = Constants {
        area_elasticity: 0.1,
        perimeter_elasticity: 1.0,
        preferred_perimeter: 3.0,
        preferred_area: 1.0,
        chirality: 0.3,
    };
    let parameters = Parameters { preferred_perimeter: 3.0, chirality: 0.3, ..Parameters::default() };
    let honeycomb = -(3f64.sqrt()) * 0.3;
    let mut shares = Vec::new();
    for seed in 1..=6 {
        let cell_box = PeriodicBox::new(lengths).unwrap();
        let positions = RandomPlacement::new(25, cell_box).draw(&mut generator(seed)).unwrap();
        let model = Model::chiral_voronoi(&parameters);
        let mut tissue = Simulation::new(positions, Domain::Periodic(cell_box), model).unwrap();
        let found = moduli::elastic(&tissue, &moduli::Settings::default()).unwrap();
        for _ in 0..20_000 {
            tissue.step(0.01).unwrap();
        }
        let h = 1e-5;
        let [plus, minus] = [h, -h].map(|h| shear_stress(tissue.positions(), lengths, &constants, h));
        let [even, odd] = [0, 1].map(|k| (plus[k] - minus[k]) / (2.0 * h));
        let expected = [found.response[2][1], found.response[3][1]];
        assert!(
            (even - expected[0]).abs() < 1e-4 && (odd - expected[1]).abs() < 1e-4,
            "{even} {odd} {expected:?}"
        );
        shares.push(-odd / honeycomb);
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    assert!((0.4..0.85).contains(&mean), "{shares:?}");
}
