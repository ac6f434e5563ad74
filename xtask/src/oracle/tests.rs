//! The oracle and the model agree.

use super::{Constants, Oracle};
use nalgebra::Vector2;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, areas, perimeters};
use voronudge_model::{Model, Parameters, jacobian, stress, velocities};
use voronudge_simulate::{RandomPlacement, generator};
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
