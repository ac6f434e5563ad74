//! Parameters put into a simulation come out of the fit.

use claims::{Noise, Tissue};
use std::ops::ControlFlow;
use voronudge_geometry::{FieldOfView, Vector};
use voronudge_infer::{
    Constraints, Error, FitParameter, Inference, KnownNoise, NoiseSource, Observation, Request, infer,
};

const LOW: Noise = Noise { position: 0.02, velocity: 0.05 };

fn tissue(cells: usize, seed: u64) -> Tissue {
    Tissue::new(cells, seed).unwrap()
}

fn fit(frames: &[Observation], request: &Request) -> Inference {
    infer(frames, request, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn exact_data_give_exact_parameters() {
    let tissue = tissue(64, 1);
    let exact = Noise { position: 0.0, velocity: 0.0 };
    // What the curvature of the forces does with errors of the stated size is taken off: these are next to none.
    let known = KnownNoise { position: Some(1e-6), velocity: Some(1e-6) };
    let request = Request { constraints: Constraints::default(), ..tissue.request(known) };
    let result = fit(&[tissue.measured(exact, 1).unwrap()], &request);
    for quantity in FitParameter::ALL {
        let (found, truth) = (result.parameters.get(quantity).value, tissue.truth(quantity));
        assert!((found / truth - 1.0).abs() < 1e-7, "{quantity:?} {found} {truth}");
    }
    assert!(result.nudge_rms < 1e-8 && result.nmse.naive < 1e-18);
    assert!(result.doubts.is_empty());
}

/// Position noise of 5 % of the cell size and velocity noise of 2 %, K_A known. Wrong contacts with sides longer than the
/// position noise are repaired; the shorter ones are beyond what the data tell.
#[test]
fn the_search_recovers_what_noise_hides() {
    let noise = Noise { position: 0.05, velocity: 0.02 };
    let seeds = 10;
    let (mut chiral, mut covered, mut naive_chiral, mut errors) = (0, 0, 0, Vec::new());
    let (mut edges, mut sides) = ([0, 0], [0, 0]);
    for seed in 0..seeds {
        let tissue = tissue(100, 100 + seed);
        let observation = tissue.measured(noise, 200 + seed).unwrap();
        let before = observation.tessellation.clone();
        let result = fit(&[observation], &tissue.request(noise.known()));
        let after = &result.frames[0].tessellation;
        let truth = tissue.truth(FitParameter::ChiralCoefficient);
        let within = |value: f64| (value / truth - 1.0).abs() < 0.03;
        chiral += usize::from(within(result.parameters.chiral_coefficient.value));
        naive_chiral += usize::from(within(result.naive.perimeter_elasticity * result.naive.chirality));
        let p_0 = result.parameters.preferred_perimeter;
        covered += usize::from(p_0.covers(4.0));
        errors.push((p_0.value / 4.0 - 1.0).abs());
        for (index, tessellation) in [&before, after].into_iter().enumerate() {
            edges[index] += tissue.wrong_edges(tessellation);
            sides[index] += tissue.lost_sides(tessellation, noise.position);
        }
    }
    errors.sort_unstable_by(f64::total_cmp);
    assert!(chiral >= 9, "K_P alpha within 3 % in {chiral} of {seeds}");
    assert!(naive_chiral <= 1, "the naive fit was right in {naive_chiral} of {seeds}");
    assert!(covered >= 8, "intervals cover P_0 in {covered} of {seeds}");
    assert!(errors[4] < 0.03, "median error of P_0 {}", errors[4]);
    assert!(2 * edges[1] <= edges[0], "wrong edges {edges:?}");
    assert!(sides[0] >= 10 && 3 * sides[1] <= sides[0], "lost sides {sides:?}");
}

#[test]
fn noise_levels_are_found_where_they_are_not_given() {
    let tissue = tissue(144, 7);
    let result = fit(&[tissue.measured(LOW, 8).unwrap()], &tissue.request(KnownNoise::default()));
    assert_eq!(result.noise_source, NoiseSource::Estimated);
    assert!((result.noise.position / LOW.position - 1.0).abs() < 0.25, "{}", result.noise.position);
    assert!((result.noise.velocity / LOW.velocity - 1.0).abs() < 0.35, "{}", result.noise.velocity);
    // What restricted maximum likelihood makes of the paper's rule for the spring constant.
    let left = 2.0 * 144.0 - result.degrees_of_freedom - 3.0;
    let identity = result.contribution_ratio / (result.degrees_of_freedom / left);
    assert!((identity - 1.0).abs() < 0.15, "{identity}");
}

/// Velocities seen on a grid of the spacing of the cells, as optical flow gives them.
#[test]
fn a_grid_of_velocities_gives_the_chirality() {
    let tissue = tissue(144, 60);
    let noise = Noise { position: 0.02, velocity: 0.02 };
    let observation = tissue.on_grid(1.0, noise, 61).unwrap();
    let result = fit(&[observation], &tissue.request(noise.known()));
    let ratio = result.parameters.chiral_coefficient.value / tissue.truth(FitParameter::ChiralCoefficient);
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
}

/// More frames with the same parameters narrow the intervals as one over the root of their number.
#[test]
fn frames_share_the_parameters() {
    let frames: Vec<Observation> = (0..4).map(|seed| tissue(64, 20).measured(LOW, seed).unwrap()).collect();
    let request = tissue(64, 20).request(LOW.known());
    let one = fit(&frames[..1], &request);
    let four = fit(&frames, &request);
    let ratio =
        one.parameters.chiral_coefficient.standard_error / four.parameters.chiral_coefficient.standard_error;
    assert!((1.5..2.7).contains(&ratio), "{ratio}");
    assert_eq!(four.frames.len(), 4);
}

/// The mirror image of a tissue has the opposite chirality and is otherwise the same, but for the draws of errors with which the curvature of
/// the forces is taken off.
#[test]
fn a_mirror_turns_the_chirality() {
    let tissue = tissue(64, 30);
    let observation = tissue.measured(LOW, 31).unwrap();
    let flip = |v: &Vector<f64>| Vector::new(-v.x, v.y);
    let mirrored = Observation::new(
        0,
        observation.positions.iter().map(flip).collect(),
        observation.velocities.values().iter().map(|v| v.as_ref().map(flip)).collect::<Vec<_>>(),
        tissue.tessellation.domain(),
        FieldOfView::default(),
    )
    .unwrap();
    let request = tissue.request(LOW.known());
    let (left, right) = (fit(&[observation], &request), fit(&[mirrored], &request));
    let (a, b) = (left.parameters, right.parameters);
    let by = |difference: f64, error: f64| difference.abs() / error;
    let chirality = by(a.chirality.value + b.chirality.value, a.chirality.standard_error);
    let [p, q] = [a.preferred_perimeter, b.preferred_perimeter];
    let perimeter = by(p.value - q.value, p.standard_error);
    assert!(chirality < 0.1 && perimeter < 0.1, "{chirality} {perimeter}");
    assert!(a.chirality.value > 4.0 * a.chirality.standard_error);
}

#[test]
fn the_caller_can_stop_a_fit() {
    let tissue = tissue(64, 40);
    let frames = [tissue.measured(LOW, 41).unwrap()];
    let stopped = infer(&frames, &tissue.request(KnownNoise::default()), &mut |_| ControlFlow::Break(()));
    assert_eq!(stopped.unwrap_err(), Error::Interrupted);
}

#[test]
fn impossible_requests_are_refused() {
    let tissue = tissue(64, 50);
    let frames = [tissue.measured(LOW, 51).unwrap()];
    let with = |change: &dyn Fn(&mut Request)| {
        let mut request = tissue.request(LOW.known());
        change(&mut request);
        infer(&frames, &request, &mut |_| ControlFlow::Continue(())).unwrap_err()
    };
    assert!(matches!(with(&|r| r.noise.position = Some(-1.0)), Error::Noise { name: "position", .. }));
    assert!(matches!(with(&|r| r.noise.velocity = Some(f64::NAN)), Error::Noise { name: "velocity", .. }));
    let nothing = Constraints::fixed([
        (FitParameter::AreaElasticity, 0.1),
        (FitParameter::PerimeterElasticity, 1.0),
        (FitParameter::PreferredPerimeter, 4.0),
        (FitParameter::Chirality, 1.0),
    ]);
    assert_eq!(with(&|r| r.constraints = nothing.clone()), Error::NothingToFit);
    let mut still = frames[0].clone();
    still.velocities.values_mut().iter_mut().for_each(|v| *v = Some(Vector::zeros()));
    let request = tissue.request(KnownNoise::default());
    assert_eq!(
        infer(&[still.clone()], &request, &mut |_| ControlFlow::Continue(())).unwrap_err(),
        Error::NothingMoves
    );
    still.velocities.values_mut().iter_mut().skip(2).for_each(|v| *v = None);
    assert!(matches!(
        infer(&[still], &request, &mut |_| ControlFlow::Continue(())).unwrap_err(),
        Error::TooFewVelocities { used: 2, .. }
    ));
}
