//! What integration in time must keep, and how accurate it is.

use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{Error, RandomPlacement, Simulation, generator, measure};

fn start(cells: usize, seed: u64, parameters: &Parameters<f64>) -> Simulation {
    let side = (cells as f64).sqrt();
    let cell_box = PeriodicBox::new([side, side]).unwrap();
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed)).unwrap();
    Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(parameters)).unwrap()
}

fn advance(mut simulation: Simulation, steps: usize, time_step: f64) -> Simulation {
    for _ in 0..steps {
        simulation.step(time_step).unwrap();
    }
    simulation
}

fn distance(a: &Simulation, b: &Simulation) -> f64 {
    let squares = a.positions().iter().zip(b.positions()).map(|(a, b)| (a - b).norm_squared());
    squares.sum::<f64>().sqrt()
}

#[test]
fn the_error_is_of_fourth_order() {
    let parameters = Parameters { chirality: 0.5, preferred_perimeter: 3.0, ..Parameters::default() };
    let begin = advance(start(25, 4, &parameters), 50, 0.02);
    let [coarse, middle, fine] =
        [(4, 0.01), (8, 0.005), (128, 0.0003125)].map(|(steps, h)| advance(begin.clone(), steps, h));
    for end in [&coarse, &middle, &fine] {
        assert_eq!(begin.tessellation().edges(), end.tessellation().edges(), "a T1 spoils the order");
    }
    let ratio = distance(&coarse, &fine) / distance(&middle, &fine);
    // 2⁴ in the limit of small steps; the next order shifts it by a few per cent here.
    assert!((ratio - 16.0).abs() < 1.0, "{ratio}");
}

#[test]
fn the_centre_of_mass_rests() {
    let parameters = Parameters { chirality: 2.0, ..Parameters::default() };
    let begin = start(100, 2, &parameters);
    let centre = |s: &Simulation| s.positions().iter().sum::<Vector<f64>>() / 100.0;
    let end = advance(begin.clone(), 200, 0.01);
    // Rounding of 800 sums over 100 cells.
    assert!((centre(&begin) - centre(&end)).norm() < 1e-11);
    assert!(distance(&begin, &end) > 1.0, "the cells themselves have moved");
}

#[test]
fn without_chirality_the_energy_decreases() {
    let mut simulation = start(64, 5, &Parameters { preferred_perimeter: 3.7, ..Parameters::default() });
    let energy = |s: &Simulation| measure::energy(s.tessellation(), s.positions(), s.model()).unwrap();
    let mut last = energy(&simulation);
    for _ in 0..500 {
        simulation.step(0.02).unwrap();
        let now = energy(&simulation);
        assert!(now <= last, "{now} after {last} at {}", simulation.time());
        last = now;
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let parameters = Parameters { chirality: 1.0, ..Parameters::default() };
    let end = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| advance(start(10_000, 6, &parameters), 3, 0.02))
    };
    let (one, two) = (end(1), end(2));
    assert_eq!(one.positions(), two.positions());
    assert_eq!(one.velocities(), two.velocities());
}

#[test]
fn a_step_that_is_too_large_is_told_and_undone() {
    let mut simulation = start(36, 1, &Parameters { chirality: 1.0, ..Parameters::default() });
    let before = simulation.clone();
    let error = simulation.step(5.0).unwrap_err();
    assert!(matches!(error, Error::StepTooLarge { time: 0.0, time_step: 5.0, .. }), "{error}");
    assert!(error.hint().is_some());
    assert_eq!(simulation.positions(), before.positions());
    assert_eq!(simulation.tessellation(), before.tessellation());
    simulation.step(0.02).unwrap();
    assert_eq!(simulation.positions(), advance(before, 1, 0.02).positions());
}

#[test]
fn a_velocity_that_is_not_finite_is_told() {
    let mut simulation =
        start(36, 1, &Parameters { area_elasticity: f64::INFINITY, ..Parameters::default() });
    let error = simulation.step(0.01).unwrap_err();
    assert!(matches!(error, Error::StepTooLarge { distance, .. } if !distance.is_finite()), "{error}");
}

#[test]
fn unusable_requests_are_refused() {
    let mut simulation = start(9, 1, &Parameters::default());
    for time_step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(simulation.step(time_step), Err(Error::TimeStep { .. })));
    }
    let model = simulation.model().clone();
    let open = Simulation::new(simulation.positions().to_vec(), Domain::Open, model);
    assert_eq!(open.unwrap_err(), Error::OpenDomain);
}
