//! Moduli in time: limits, sums, and the strains that they are measured by.

use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_linalg::Complex64;
use voronudge_model::{Model, Parameters};
use voronudge_simulate::moduli::{
    Deformation, Dynamic, DynamicProtocol, Motion, Relaxation, Settings, Settled, Strain, after_a_step,
    elastic, parts, whole,
};
use voronudge_simulate::{Error, RandomPlacement, Simulation, generator, honeycomb};

fn solid(seed: u64) -> Settled {
    let cell_box = PeriodicBox::new([4.0, 4.0]).unwrap();
    let positions = RandomPlacement::new(16, cell_box).draw(&mut generator(seed)).unwrap();
    let parameters = Parameters { preferred_perimeter: 3.0, chirality: 0.5, ..Parameters::default() };
    let model = Model::chiral_voronoi(&parameters);
    let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model).unwrap();
    let settled = Settled::new(&simulation, &Relaxation::default(), &go_on).unwrap();
    assert_eq!(settled.motion(), Motion::AtRest);
    settled
}

fn go_on() -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn protocol(frequencies: Vec<f64>) -> DynamicProtocol {
    DynamicProtocol { frequencies, strain: 1e-5, amplitude: 1e-4, time: 1.0, time_step: 0.005 }
}

fn values(dynamic: &Dynamic) -> [Complex64; 4] {
    dynamic.moduli.map(|own| own.unwrap()).map(|own| Complex64::new(own.storage, own.loss))
}

fn apart(a: [Complex64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Slow strains find the moduli at rest, fast ones those without relaxation.
#[test]
fn both_limits_are_the_elastic_moduli() {
    let solid = solid(1);
    let elastic = solid.elastic(&Settings::default(), &go_on).unwrap();
    let found = solid.dynamic(&protocol(vec![1e-6, 1e7]), &go_on).unwrap();
    let [slow, fast] = [0, 1].map(|k| values(&found[k]));
    assert!(apart(slow, elastic.moduli.to_array()) < 1e-5, "{slow:?} {elastic:?}");
    assert!(apart(fast, elastic.affine.to_array()) < 1e-5, "{fast:?} {elastic:?}");
    assert!(apart(fast, elastic.moduli.to_array()) > 0.01, "{elastic:?}");
}

/// `2/π ∫ G″ dω/ω` is what the modulus grows by from slow strains to fast ones (Kramers and Kronig).
#[test]
fn losses_add_up_to_the_growth_of_the_storage_moduli() {
    let solid = solid(2);
    let steps = 400;
    let step = (1e12f64.ln()) / f64::from(steps);
    let frequencies: Vec<f64> = (0..=steps).map(|k| 1e-6 * (f64::from(k) * step).exp()).collect();
    let found = solid.dynamic(&protocol(frequencies), &go_on).unwrap();
    let (first, last) = (values(&found[0]), values(&found[found.len() - 1]));
    for k in 0..4 {
        let losses: f64 = found.iter().map(|own| values(own)[k].im * step).sum();
        let growth = last[k].re - first[k].re;
        let sum = losses * 2.0 / std::f64::consts::PI;
        assert!((sum - growth).abs() < 1e-3 * growth.abs().max(0.01), "{k}: {sum} {growth}");
    }
}

/// A tissue at rest that is sheared in time answers as its linear response says.
#[test]
fn a_shear_in_time_finds_the_linear_response() {
    let solid = solid(3);
    let protocol = DynamicProtocol { time: 60.0, ..protocol(vec![3.0]) };
    let [storage, loss] = solid.linear_response(3.0, 1e-5).unwrap();
    // A tissue that is not given time to be found at rest is taken for one that flows.
    let hasty = Relaxation { longest: 0.0, tolerance: 0.0, slow: 0.0, ..Relaxation::default() };
    let moving = Settled::new(solid.simulation(), &hasty, &go_on).unwrap();
    assert_eq!((moving.motion(), moving.speed()), (Motion::Flowing, solid.speed()));
    let in_time = &moving.dynamic(&protocol, &go_on).unwrap()[0];
    // Of the shear along x alone; this tissue is small, and not isotropic.
    for (k, part) in [(2, 3), (3, 2)] {
        let (storage, loss) = (storage[part][2], loss[part][2]);
        let found = in_time.moduli[k].unwrap();
        let apart = (storage - found.storage).hypot(loss - found.loss);
        assert!(apart < 2e-3 && loss.abs() > 0.01, "{storage} {loss} {found:?}");
    }
}

#[test]
fn a_honeycomb_loses_nothing() {
    let (positions, cell_box) = honeycomb(16).unwrap();
    let parameters = Parameters { preferred_perimeter: 3.0, chirality: 0.3, ..Parameters::default() };
    let model = Model::chiral_voronoi(&parameters);
    let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model).unwrap();
    let settled = Settled::new(&simulation, &Relaxation::default(), &go_on).unwrap();
    for own in settled.dynamic(&protocol(vec![0.1, 1.0, 10.0]), &go_on).unwrap() {
        let [bulk, odd_bulk, shear, odd_shear] = values(&own);
        assert!((odd_shear + 3f64.sqrt() * 0.3).norm() < 1e-8 && odd_bulk.norm() < 1e-8, "{own:?}");
        assert!(bulk.im.abs() < 1e-8 && shear.im.abs() < 1e-8 && bulk.re > shear.re, "{own:?}");
    }
}

#[test]
fn amounts_that_cannot_be_are_refused() {
    let solid = solid(1);
    let refused = solid.dynamic(&protocol(vec![1.0, 0.0]), &go_on);
    assert_eq!(refused.unwrap_err(), Error::Rate { name: "angular frequency", value: 0.0 });
    let still = DynamicProtocol { amplitude: 0.0, ..protocol(vec![1.0]) };
    assert!(solid.dynamic(&still, &go_on).is_err());
}

#[test]
fn the_box_has_the_strain_up_to_its_turn() {
    for strain in Strain::ALL {
        let (amount, stretch) = (0.3, strain.stretch(0.3));
        let deformation = Deformation::new(strain, amount);
        let [c, n] = deformation.turn();
        for r in [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)] {
            let placed = deformation.displaced(r);
            let turned = Vector::new(c * placed.x - n * placed.y, n * placed.x + c * placed.y);
            let expected = Vector::new(
                stretch[0][0] * r.x + stretch[0][1] * r.y,
                stretch[1][0] * r.x + stretch[1][1] * r.y,
            );
            assert!((turned - expected).norm() < 1e-15, "{strain:?}");
        }
        let cell_box = PeriodicBox::sheared([3.0, 2.0], 0.4).unwrap();
        let deformed = deformation.cell_box(&cell_box).unwrap();
        let corner = deformation.displaced(cell_box.translation([1, 1]));
        assert!((corner - deformed.translation([1, 1])).norm() < 1e-15);
    }
}

#[test]
fn a_stress_is_the_sum_of_its_parts() {
    let stress = [[1.0, 2.0], [3.0, 5.0]];
    assert_eq!(whole(parts(stress)), stress);
    // Pressure and torque do not know of turns.
    let turned = parts(Deformation::new(Strain::PureShear2, 0.5).turn_back(stress));
    assert!((turned[0] - 3.0).abs() < 1e-15 && (turned[1] - 0.5).abs() < 1e-15);
}

/// The first value is that of cells that follow the strain, the last that of cells at rest.
#[test]
fn moduli_go_from_those_without_relaxation_to_those_at_rest() {
    let cell_box = PeriodicBox::new([4.0, 4.0]).unwrap();
    let positions = RandomPlacement::new(16, cell_box).draw(&mut generator(1)).unwrap();
    let parameters = Parameters { preferred_perimeter: 3.0, chirality: 0.3, ..Parameters::default() };
    let model = Model::chiral_voronoi(&parameters);
    let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model).unwrap();
    let settings = Settings::default();
    let found = elastic(&simulation, &settings).unwrap();
    let times = [0.0, 0.1, 60.0];
    let series = after_a_step(&simulation, &settings.relaxation, 5e-6, &times, &go_on).unwrap().unwrap();
    let near = |k: usize, expected: [f64; 4]| {
        let pairs = series[k].to_array().into_iter().zip(expected);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(near(0, found.affine.to_array()) < 1e-6, "{series:?} {found:?}");
    assert!(near(2, found.moduli.to_array()) < 1e-3, "{series:?} {found:?}");
    assert!(near(0, found.moduli.to_array()) > 0.01, "{series:?} {found:?}");
}
