//! Measurements on solids and liquids.

use num_dual::Dual64;
use rand::Rng;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_observables::hexatic;
use voronudge_simulate::measure::{LyapunovExponent, LyapunovSchedule, largest_lyapunov_exponent};
use voronudge_simulate::{Error, RandomPlacement, Schedule, Simulation, generator, run};

fn tissue(cells: usize, preferred_perimeter: f64, chirality: f64) -> Simulation {
    let parameters = Parameters { preferred_perimeter, chirality, ..Parameters::default() };
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2]).unwrap();
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(1)).unwrap();
    Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(&parameters)).unwrap()
}

fn exponent(simulation: &Simulation, steps: usize) -> LyapunovExponent {
    let schedule = LyapunovSchedule { time_step: 0.01, transient: 1000, steps, renormalisation: 10 };
    let domain = simulation.tessellation().domain();
    let (positions, model) = (simulation.positions(), simulation.model());
    largest_lyapunov_exponent(positions, domain, model, &schedule, 1, |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn a_chiral_liquid_is_chaotic_and_a_solid_is_not() {
    let mut liquid = tissue(64, 4.0, 1.0);
    (0..500).for_each(|_| liquid.step(0.01).unwrap());
    let of_liquid = exponent(&liquid, 2000);
    assert!(of_liquid.value > 5.0 * of_liquid.standard_error.unwrap(), "{of_liquid:?}");
    let mut solid = tissue(64, 3.2, 0.2);
    (0..3000).for_each(|_| solid.step(0.01).unwrap());
    let of_solid = exponent(&solid, 1000);
    assert!(of_solid.value < -0.01, "{of_solid:?}");
}

#[test]
fn cells_of_a_liquid_change_neighbours_and_those_of_a_solid_do_not() {
    let rate = |simulation: &mut Simulation| {
        let schedule = Schedule { time: 20.0, time_step: 0.01, frames: 1 };
        let summary = run(simulation, &schedule, |_| ControlFlow::Continue(())).unwrap();
        (summary.transition_rate.unwrap(), summary.mean_square_velocity_error.unwrap())
    };
    let (liquid, error) = rate(&mut tissue(100, 4.0, 1.0));
    assert!(liquid > 0.5, "{liquid}");
    // The errors of a thousand independent values of a relative scatter of a tenth would be 0.03.
    assert!(error > 0.03, "{error}");
    assert_eq!(rate(&mut tissue(100, 3.0, 0.2)).0, 0.0);
}

#[test]
fn the_order_of_a_liquid_is_low_and_that_of_grains_is_hidden_in_the_average() {
    let mut liquid = tissue(400, 4.0, 1.0);
    (0..300).for_each(|_| liquid.step(0.01).unwrap());
    let order = hexatic(liquid.tessellation(), liquid.positions());
    assert!(order.order() < 0.3 && order.mean_modulus > order.order(), "{order:?}");
}

#[test]
fn momentum_is_zero_to_rounding() {
    let mut liquid = tissue(100, 4.0, 2.0);
    for _ in 0..500 {
        liquid.step(0.005).unwrap();
        let momentum: Vector<f64> = liquid.velocities().iter().sum();
        assert!(momentum.norm() / 100.0 < 1e-12, "{momentum}");
    }
}

#[test]
fn impossible_measurements_are_refused() {
    let simulation = tissue(16, 3.8, 0.0);
    let (positions, model) = (simulation.positions(), simulation.model());
    let domain = simulation.tessellation().domain();
    let sound = LyapunovSchedule { time_step: 0.01, transient: 2, steps: 2, renormalisation: 1 };
    let refusal = |domain, schedule: LyapunovSchedule| {
        let observe = |_| ControlFlow::Continue(());
        largest_lyapunov_exponent(positions, domain, model, &schedule, 1, observe).unwrap_err()
    };
    assert_eq!(refusal(Domain::Open, sound), Error::OpenDomain);
    assert_eq!(refusal(domain, LyapunovSchedule { steps: 0, ..sound }), Error::NoFrames);
    assert!(matches!(refusal(domain, LyapunovSchedule { time_step: 0.0, ..sound }), Error::TimeStep { .. }));
}

fn tangent_of(r: &Vector<Dual64>) -> Vector<f64> {
    Vector::new(r.x.eps, r.y.eps)
}

fn without_translation(tangent: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let mean = tangent.iter().sum::<Vector<f64>>() / tangent.len() as f64;
    tangent.iter().map(|u| u - mean).collect()
}

fn length(tangent: &[Vector<f64>]) -> f64 {
    tangent.iter().map(Vector::norm_squared).sum::<f64>().sqrt()
}

fn unit_tangent(drawn: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let own = without_translation(drawn);
    let length = length(&own);
    own.iter().map(|u| u / length).collect()
}

/// The tangent vector against the difference of two trajectories that begin close to each other, across no T1; the exponent is its growth, however
/// often it is made a unit vector on the way.
#[test]
fn the_tangent_vector_is_the_difference_of_neighbouring_trajectories() {
    let cell_box = PeriodicBox::new([6.0, 6.0]).unwrap();
    let domain = Domain::Periodic(cell_box);
    let start = RandomPlacement::new(36, cell_box).draw(&mut generator(3)).unwrap();
    let parameters = Parameters { preferred_perimeter: 3.6, chirality: 0.7, ..Parameters::default() };
    let model = Model::chiral_voronoi(&parameters);
    // Of the seed, without translations, of length one.
    let mut rng = generator(5);
    let drawn: Vec<Vector<f64>> =
        start.iter().map(|_| Vector::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0))).collect();
    let unit = unit_tangent(&drawn);
    let dual =
        |(r, u): (&Vector<f64>, &Vector<f64>)| Vector::new(Dual64::new(r.x, u.x), Dual64::new(r.y, u.y));
    let seeded = start.iter().zip(&unit).map(dual).collect();
    let mut tangent = Simulation::new(seeded, domain, model.lift::<Dual64>()).unwrap();
    let size = 1e-6;
    let beside = |sign: f64| {
        let at =
            |r: &Vector<Dual64>| Vector::new(r.x.re + sign * size * r.x.eps, r.y.re + sign * size * r.y.eps);
        Simulation::new(tangent.positions().iter().map(at).collect(), domain, model.clone()).unwrap()
    };
    let (mut plus, mut minus) = (beside(1.0), beside(-1.0));
    for _ in 0..20 {
        tangent.step(0.005).unwrap();
        plus.step(0.005).unwrap();
        minus.step(0.005).unwrap();
        assert_eq!(plus.tessellation().edges(), minus.tessellation().edges());
    }
    let pairs = plus.positions().iter().zip(minus.positions());
    for ((plus, minus), exact) in pairs.zip(tangent.positions()) {
        let difference = (plus - minus) / (2.0 * size);
        assert!((difference - tangent_of(exact)).norm() < 1e-7, "{difference}");
    }
    let grown: Vec<Vector<f64>> = tangent.positions().iter().map(tangent_of).collect();
    let rate = (length(&without_translation(&grown)) / length(&unit)).ln() / 0.1;
    for renormalisation in [4, 20] {
        let schedule = LyapunovSchedule { time_step: 0.005, transient: 0, steps: 20, renormalisation };
        let go_on = |_| ControlFlow::Continue(());
        let found = largest_lyapunov_exponent(&start, domain, &model, &schedule, 5, go_on).unwrap();
        assert!((found.value - rate).abs() < 1e-9, "{found:?} {rate}");
    }
}
