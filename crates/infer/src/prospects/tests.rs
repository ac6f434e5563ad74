use super::*;
use crate::sample::observation;
use crate::tracks::sample::Filmed;
use crate::{
    CrossValidation, KnownNoise, Observation, Request, infer, infer_tracks, prospects as of_snapshots,
};
use std::ops::ControlFlow;

fn request(noise: KnownNoise) -> Request {
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.1)]);
    Request { noise, cross_validation: CrossValidation::Skipped, ..Request::new(constraints) }
}

fn fit(frames: &[Observation], position: f64) -> Inference {
    let noise = KnownNoise { position: Some(position), velocity: Some(0.05) };
    infer(frames, &request(noise), &mut |_| ControlFlow::Continue(())).unwrap()
}

fn frames(count: u64, position: f64) -> Vec<Observation> {
    (0..count).map(|seed| observation(position, 0.05, 40 + seed)).collect()
}

fn errors(result: &Inference) -> [f64; 2] {
    [FitParameter::PreferredPerimeter, FitParameter::ChiralCoefficient]
        .map(|quantity| result.parameters.get(quantity).standard_error)
}

/// The standard errors of a fit of more frames, and of sharper positions, are those that were foreseen.
#[test]
fn what_is_foreseen_of_snapshots_comes_true() {
    let data = frames(4, 0.02);
    let now = fit(&data, 0.02);
    let noise = KnownNoise { position: Some(0.02), velocity: Some(0.05) };
    let foreseen = of_snapshots(&data, &request(noise), &now).unwrap().unwrap();
    assert!(foreseen.with(Design::HalfTheInterval).is_none());
    let better = [
        (Design::TwiceTheFrames, fit(&frames(8, 0.02), 0.02)),
        (Design::HalfThePositionNoise, fit(&frames(4, 0.01), 0.01)),
    ];
    for (design, then) in better {
        let share = foreseen.with(design).unwrap().parameters;
        let share = [share[2], share[4]];
        for (k, (before, after)) in errors(&now).into_iter().zip(errors(&then)).enumerate() {
            let ratio = after / before / share[k];
            assert!((ratio - 1.0).abs() < 0.25, "{design:?} {k}: {} instead of {}", after / before, share[k]);
        }
        assert!(foreseen.with(design).unwrap().parameters[0].is_nan());
    }
    // In a periodic box all cells count.
    let [frames, field] = [Design::TwiceTheFrames, Design::TwiceTheField]
        .map(|design| foreseen.with(design).unwrap().parameters[4]);
    assert!((frames - 0.5f64.sqrt()).abs() < 1e-9 && frames == field);
}

/// The same of tracks that are seen twice as often.
#[test]
#[ignore = "slow"]
fn what_is_foreseen_of_tracks_comes_true() {
    let seen = |frames: usize, step: f64| {
        let (movie, _) = Filmed { size: [100, frames], step, error: 0.02, seed: 3 }.movie();
        let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
        let request = Request { cross_validation: CrossValidation::Skipped, ..Request::new(constraints) };
        infer_tracks(&movie, &request, &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let (now, tracked) = seen(4, 0.16);
    let foreseen = tracked.prospects.unwrap();
    for (design, (then, _)) in
        [(Design::HalfTheInterval, seen(7, 0.08)), (Design::TwiceTheFrames, seen(8, 0.16))]
    {
        let share = foreseen.with(design).unwrap().parameters[4];
        let ratio = errors(&then)[1] / errors(&now)[1];
        assert!((ratio / share - 1.0).abs() < 0.25, "{design:?}: {ratio} instead of {share}");
    }
}

#[test]
fn an_open_field_gains_more_than_its_area() {
    assert!(growth_with_area(Domain::Open, 0.5) > 2.5);
    assert!((growth_with_area(Domain::Open, 1.0) - 2.0).abs() < 1e-12);
}
