//! Parameters put into a simulation come out of the fit.

use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
use voronudge_infer::{Error, Fixed, Inference, NoiseSource, Observation, Request, infer};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{RandomPlacement, Simulation, generator};

const TRUTH: Parameters<f64> = Parameters {
    area_elasticity: 0.1,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 4.0,
    preferred_area: 1.0,
    chirality: 3.4,
};

/// A snapshot of a chiral liquid of unit cells, in units of its root mean square velocity.
struct Snapshot {
    positions: Vec<Vector<f64>>,
    velocities: Vec<Vector<f64>>,
    domain: Domain,
    rms: f64,
}

fn snapshot(cells: usize, seed: u64) -> Snapshot {
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2]).unwrap();
    let start = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed)).unwrap();
    let domain = Domain::Periodic(cell_box);
    let mut simulation = Simulation::new(start, domain, Model::chiral_voronoi(&TRUTH)).unwrap();
    (0..400).for_each(|_| simulation.step(0.005).unwrap());
    let velocities = simulation.velocities().to_vec();
    let rms = (velocities.iter().map(|v| v.norm_squared()).sum::<f64>() / cells as f64).sqrt();
    Snapshot { positions: simulation.positions().to_vec(), velocities, domain, rms }
}

impl Snapshot {
    /// With Gaussian noise on every component; velocity noise relative to the root mean square velocity.
    fn measured(&self, position_noise: f64, velocity_noise: f64, seed: u64) -> Observation {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut noisy = |v: &Vector<f64>, sigma: f64| {
            let normal = Normal::new(0.0, sigma).unwrap();
            Vector::new(v.x + normal.sample(&mut rng), v.y + normal.sample(&mut rng))
        };
        let positions = self.positions.iter().map(|r| noisy(r, position_noise)).collect();
        let velocities =
            self.velocities.iter().map(|v| Some(noisy(&(v / self.rms), velocity_noise))).collect();
        Observation::new(0, positions, velocities, self.domain, 3.0).unwrap()
    }

    fn request(&self, noise: Option<(f64, f64)>) -> Request {
        Request {
            fixed: Fixed { area_elasticity: Some(TRUTH.area_elasticity / self.rms), ..Fixed::default() },
            preferred_area: 1.0,
            position_noise: noise.map(|n| n.0),
            velocity_noise: noise.map(|n| n.1),
            max_steps: 60,
        }
    }

    /// Wrong Delaunay edges of a tessellation.
    fn wrong_edges(&self, tessellation: &Tessellation) -> usize {
        let truth = Tessellation::new(&self.positions, self.domain).unwrap().edges();
        tessellation.edges().iter().filter(|edge| truth.binary_search(edge).is_err()).count()
    }
}

fn fit(frames: &[Observation], request: &Request) -> Inference {
    infer(frames, request, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn exact_data_give_exact_parameters() {
    let snapshot = snapshot(64, 1);
    let observation = snapshot.measured(0.0, 0.0, 1);
    let request = Request { fixed: Fixed::default(), ..snapshot.request(Some((1e-3, 1e-3))) };
    let result = fit(&[observation], &request);
    let p = result.parameters;
    assert!((p.area_elasticity.value * snapshot.rms - 0.1).abs() < 1e-8);
    assert!((p.perimeter_elasticity.value * snapshot.rms - 1.0).abs() < 1e-8);
    assert!((p.preferred_perimeter.value - 4.0).abs() < 1e-8);
    assert!((p.chirality.value - 3.4).abs() < 1e-8);
    assert!(result.nudge_rms < 1e-8 && result.nmse.naive < 1e-18);
}

/// Position noise of 5 % of the cell size and velocity noise of 2 %, K_A known. The bound on P_0 is what these data can
/// give: its standard error is about 2.5 %, so that 2 % is met by a little more than half of the snapshots.
#[test]
fn nudging_recovers_what_noise_hides() {
    let seeds = 10;
    let (mut chiral, mut covered, mut naive_chiral, mut errors) = (0, 0, 0, Vec::new());
    for seed in 0..seeds {
        let snapshot = snapshot(100, 100 + seed);
        let observation = snapshot.measured(0.05, 0.02, 200 + seed);
        let before = snapshot.wrong_edges(&observation.tessellation);
        let result = fit(&[observation], &snapshot.request(Some((0.05, 0.02))));
        let within = |value: f64| (value * snapshot.rms / 3.4 - 1.0).abs() < 0.05;
        chiral += usize::from(within(result.parameters.chiral_coefficient.value));
        naive_chiral += usize::from(within(result.naive.perimeter_elasticity * result.naive.chirality));
        let p_0 = result.parameters.preferred_perimeter;
        covered += usize::from((p_0.value - 4.0).abs() < 1.96 * p_0.standard_error);
        errors.push((p_0.value / 4.0 - 1.0).abs());
        assert!(snapshot.wrong_edges(&result.frames[0].tessellation) <= before + 2);
    }
    errors.sort_unstable_by(f64::total_cmp);
    assert!(chiral >= 9, "K_P alpha within 5 % in {chiral} of {seeds}");
    assert!(naive_chiral <= 1, "the naive fit was right in {naive_chiral} of {seeds}");
    assert!(covered >= 8, "intervals cover P_0 in {covered} of {seeds}");
    assert!(errors[4] < 0.03, "median error of P_0 {}", errors[4]);
}

#[test]
fn noise_levels_are_found_where_they_are_not_given() {
    let snapshot = snapshot(144, 7);
    let result = fit(&[snapshot.measured(0.02, 0.05, 8)], &snapshot.request(None));
    assert_eq!(result.noise_source, NoiseSource::Estimated);
    assert!((result.noise.position / 0.02 - 1.0).abs() < 0.3, "{}", result.noise.position);
    assert!((result.noise.velocity / 0.05 - 1.0).abs() < 0.4, "{}", result.noise.velocity);
}

/// More frames with the same parameters narrow the intervals as one over the root of their number.
#[test]
fn frames_share_the_parameters() {
    let frames: Vec<Observation> = (0..4).map(|seed| snapshot(64, 20).measured(0.02, 0.05, seed)).collect();
    let request = snapshot(64, 20).request(Some((0.02, 0.05)));
    let one = fit(&frames[..1], &request);
    let four = fit(&frames, &request);
    let ratio =
        one.parameters.chiral_coefficient.standard_error / four.parameters.chiral_coefficient.standard_error;
    assert!((1.5..2.7).contains(&ratio), "{ratio}");
    assert_eq!(four.frames.len(), 4);
}

/// The mirror image of a tissue has the opposite chirality and is otherwise the same.
#[test]
fn a_mirror_turns_the_chirality() {
    let snapshot = snapshot(64, 30);
    let observation = snapshot.measured(0.02, 0.05, 31);
    let flip = |v: &Vector<f64>| Vector::new(-v.x, v.y);
    let mirrored = Observation::new(
        0,
        observation.positions.iter().map(flip).collect(),
        observation.velocities.iter().map(|v| v.as_ref().map(flip)).collect(),
        snapshot.domain,
        3.0,
    )
    .unwrap();
    let request = snapshot.request(Some((0.02, 0.05)));
    let (left, right) = (fit(&[observation], &request), fit(&[mirrored], &request));
    let (a, b) = (left.parameters, right.parameters);
    assert!((a.chirality.value + b.chirality.value).abs() < 1e-3 * a.chirality.value.abs());
    assert!((a.preferred_perimeter.value - b.preferred_perimeter.value).abs() < 1e-3);
}

#[test]
fn the_caller_can_stop_a_fit() {
    let snapshot = snapshot(64, 40);
    let frames = [snapshot.measured(0.02, 0.05, 41)];
    let stopped = infer(&frames, &snapshot.request(None), &mut |_| ControlFlow::Break(()));
    assert_eq!(stopped.unwrap_err(), Error::Interrupted);
}

#[test]
fn impossible_requests_are_refused() {
    let snapshot = snapshot(64, 50);
    let frames = [snapshot.measured(0.0, 0.0, 51)];
    let with = |change: &dyn Fn(&mut Request)| {
        let mut request = snapshot.request(Some((0.02, 0.05)));
        change(&mut request);
        infer(&frames, &request, &mut |_| ControlFlow::Continue(())).unwrap_err()
    };
    assert!(matches!(with(&|r| r.position_noise = Some(-1.0)), Error::Noise { name: "position", .. }));
    assert!(matches!(with(&|r| r.velocity_noise = Some(f64::NAN)), Error::Noise { name: "velocity", .. }));
    let nothing = Fixed {
        area_elasticity: Some(0.1),
        perimeter_elasticity: Some(1.0),
        preferred_perimeter: Some(4.0),
        chirality: Some(1.0),
    };
    assert_eq!(with(&|r| r.fixed = nothing), Error::NothingToFit);
    let mut still = frames[0].clone();
    still.velocities.iter_mut().for_each(|v| *v = Some(Vector::zeros()));
    let request = snapshot.request(None);
    assert_eq!(
        infer(&[still.clone()], &request, &mut |_| ControlFlow::Continue(())).unwrap_err(),
        Error::NothingMoves
    );
    still.velocities.iter_mut().skip(2).for_each(|v| *v = None);
    assert!(matches!(
        infer(&[still], &request, &mut |_| ControlFlow::Continue(())).unwrap_err(),
        Error::TooFewVelocities { used: 2, .. }
    ));
}
