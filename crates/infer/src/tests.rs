//! Tests of whole fits of a small tissue.

use crate::sample::{COEFFICIENTS, flow, observation};
use crate::{
    Constraints, CrossValidation, Error, FitParameter, Inference, Keeper, Known, KnownNoise, Loss, Method,
    Observation, Prior, Request, Unkept, Window, WindowKind, bootstrap, infer, landscape, profile,
};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

fn request(constraints: Constraints) -> Request {
    Request {
        noise: KnownNoise { position: Some(0.02), velocity: Some(0.05) },
        cross_validation: CrossValidation::Skipped,
        ..Request::new(constraints)
    }
}

fn fit(frames: &[Observation], request: &Request) -> Inference {
    infer(frames, request, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn a_bound_holds_the_estimate_and_ends_the_interval() {
    let frames = [observation(0.02, 0.05, 3)];
    let free = fit(&frames, &request(Constraints::default()));
    let k_a = free.parameters.area_elasticity;
    // A bound above the estimate is active, one far below changes nothing.
    for (bound, active) in
        [(k_a.value + 0.5 * k_a.standard_error, true), (k_a.value - 9.0 * k_a.standard_error, false)]
    {
        let bounds = [(FitParameter::AreaElasticity, [bound, f64::INFINITY])].into();
        let bounded = fit(&frames, &request(Constraints { bounds, ..Constraints::default() }));
        let found = bounded.parameters.area_elasticity;
        if active {
            assert!((found.value - bound).abs() < 1e-9 * bound.abs().max(1.0), "{} {bound}", found.value);
            assert!((found.interval[0].unwrap() - bound).abs() < 1e-6, "{:?}", found.interval);
            assert!(bounded.objective >= free.objective - 1e-6);
        } else {
            assert!((found.value - k_a.value).abs() < 1e-3 * k_a.standard_error);
        }
    }
}

#[test]
fn a_prior_pulls_and_narrows() {
    let frames = [observation(0.02, 0.05, 4)];
    let free = fit(&frames, &request(Constraints::default())).parameters.preferred_perimeter;
    let mean = free.value + free.standard_error;
    let prior = Prior { mean, standard_deviation: free.standard_error };
    let priors = [(FitParameter::PreferredPerimeter, prior)].into();
    let pulled = fit(&frames, &request(Constraints { priors, ..Constraints::default() }))
        .parameters
        .preferred_perimeter;
    // Two measurements of equal precision: half way, and narrower by the square root of two.
    assert!(
        (pulled.value - 0.5 * (mean + free.value)).abs() < 0.15 * free.standard_error,
        "{pulled:?} {free:?}"
    );
    assert!((pulled.standard_error / free.standard_error * 2f64.sqrt() - 1.0).abs() < 0.1);
}

#[test]
fn a_profile_is_about_the_parabola_of_its_interval() {
    let frames = [observation(0.01, 0.05, 5)];
    let request = Request {
        noise: KnownNoise { position: Some(0.01), velocity: Some(0.05) },
        ..request(Constraints::fixed([(FitParameter::AreaElasticity, COEFFICIENTS[0])]))
    };
    let result = fit(&frames, &request);
    let quantity = FitParameter::ChiralCoefficient;
    let curve = profile(&frames, &request, &result, quantity, 9, &mut |_| ControlFlow::Continue(())).unwrap();
    let expected = result.parameters.chiral_coefficient;
    for (found, linear) in curve.interval.into_iter().zip(expected.interval) {
        let (found, linear) = (found.unwrap(), linear.unwrap());
        assert!((found - linear).abs() < 0.4 * expected.standard_error, "{curve:?} {expected:?}");
    }
    let held = profile(&frames, &request, &result, FitParameter::AreaElasticity, 9, &mut |_| {
        ControlFlow::Continue(())
    });
    assert!(matches!(held, Err(Error::Constraint(_))));
}

#[test]
fn refitted_landscapes_lie_below_those_with_fixed_nudges() {
    let frames = [observation(0.02, 0.05, 6)];
    let request = request(Constraints::fixed([(FitParameter::AreaElasticity, COEFFICIENTS[0])]));
    let result = fit(&frames, &request);
    let quantities = [FitParameter::PreferredPerimeter, FitParameter::Chirality];
    let map =
        landscape(&frames, &request, &result, quantities, 5, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!((map.fixed.len(), map.refitted.len()), (25, 25));
    // The middle point is the estimate; everything else can only gain from fitting again.
    assert!(map.fixed[12] < 0.1 && map.refitted[12] < 0.1, "{} {}", map.fixed[12], map.refitted[12]);
    let lower =
        map.fixed.iter().zip(&map.refitted).filter(|(fixed, refitted)| **refitted <= **fixed + 0.5).count();
    assert!(lower >= 24, "{lower}");
}

/// Keeps replicates in memory.
#[derive(Default)]
struct Kept {
    made: BTreeMap<usize, Option<Vec<f64>>>,
    news: usize,
    /// Which half is made here.
    of_two: Option<usize>,
}

impl Keeper for Kept {
    fn begin(&mut self, _: &Inference, _: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn known(&self, index: usize) -> Known {
        match self.made.get(&index) {
            Some(outcome) => Known::Made(outcome.clone()),
            None if self.of_two.is_some_and(|half| index % 2 != half) => Known::Elsewhere,
            None => Known::Missing,
        }
    }

    fn keep(&mut self, index: usize, outcome: Option<&[f64]>) -> ControlFlow<()> {
        self.news += 1;
        self.made.insert(index, outcome.map(<[f64]>::to_vec));
        ControlFlow::Continue(())
    }
}

#[test]
fn the_bootstrap_spreads_like_the_standard_error_and_repeats() {
    let frames = [observation(0.02, 0.05, 7)];
    let request = request(Constraints::fixed([(FitParameter::AreaElasticity, COEFFICIENTS[0])]));
    let result = fit(&frames, &request);
    let mut kept = Kept::default();
    let again =
        |kept: &mut Kept| bootstrap(&frames, &request, &result, 60, kept, &mut |_| ControlFlow::Continue(()));
    // Elsewhere the even ones are made, here the others.
    kept.of_two = Some(0);
    assert_eq!(again(&mut kept), Err(Error::Interrupted));
    assert_eq!(kept.made.keys().copied().collect::<Vec<_>>(), (0..60).step_by(2).collect::<Vec<_>>());
    kept = Kept { made: kept.made, ..Kept::default() };
    let first = again(&mut kept).unwrap();
    assert_eq!((kept.news, kept.made.len()), (30, 60));
    let second =
        bootstrap(&frames, &request, &result, 60, &mut Unkept, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(first, second);
    assert_eq!(first.failed, 0);
    let values = first.values(FitParameter::ChiralCoefficient);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt();
    let ratio = spread / result.parameters.chiral_coefficient.standard_error;
    assert!((0.6..1.7).contains(&ratio), "{ratio}");
}

#[test]
fn a_flow_field_without_noise_gives_the_coefficients() {
    for (kind, width) in
        [(WindowKind::Square, 1.3), (WindowKind::Gaussian, 0.5), (WindowKind::GaussianArea, 0.5)]
    {
        let window = Window { kind, width };
        let frames = [flow(window)];
        let request = Request {
            noise: KnownNoise { position: Some(1e-3), velocity: Some(1e-3) },
            ..request(Constraints::default())
        };
        let found = fit(&frames, &request).coefficients;
        for (found, truth) in found.iter().zip(COEFFICIENTS) {
            assert!((found - truth).abs() < 1e-6, "{window:?} {found} {truth}");
        }
    }
}

/// The descent of the paper's loss goes down, but nowhere near as far.
#[test]
fn the_search_finds_a_lower_objective_than_first_order_descent() {
    let frames = [observation(0.05, 0.02, 8)];
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, COEFFICIENTS[0])]);
    let search =
        Request { noise: KnownNoise { position: Some(0.05), velocity: Some(0.02) }, ..request(constraints) };
    let found = fit(&frames, &search);
    for loss in [Loss::Norms, Loss::Squares] {
        let descent = Request { method: Method::Descent { max_steps: 200, loss }, ..search.clone() };
        let compared = fit(&frames, &descent);
        assert!(compared.trace.last() < compared.trace.first(), "{loss:?}");
        assert!(found.objective < compared.objective, "{loss:?} {} {}", found.objective, compared.objective);
    }
}

/// Flips never make the objective worse, and further starts neither.
#[test]
fn more_effort_never_ends_higher() {
    let frames = [observation(0.08, 0.03, 9)];
    let with = |starts| Request {
        method: Method::Search { max_steps: 60, starts },
        noise: KnownNoise { position: Some(0.08), velocity: Some(0.03) },
        ..request(Constraints::default())
    };
    let (one, three) = (fit(&frames, &with(1)), fit(&frames, &with(3)));
    assert!(three.objective <= one.objective);
    assert_eq!(three.starts.len(), 3);
    assert!(one.trace.last().is_some_and(|last| (last - one.objective).abs() < 1e-6 * one.objective));
}

/// A model that lacks what moves the cells is not trusted.
#[test]
fn a_misfit_is_doubted() {
    let mut frame = observation(0.01, 0.01, 10);
    for (k, v) in frame.velocities.values_mut().iter_mut().flatten().enumerate() {
        v.x += 1.0 + 0.5 * (k as f64).sin();
    }
    let request = Request {
        noise: KnownNoise { position: Some(0.01), velocity: Some(0.01) },
        ..request(Constraints::default())
    };
    assert!(!fit(&[frame], &request).doubts.is_empty());
}

/// A smooth flow on top of the tissue's own does not matter where a background is allowed.
#[test]
fn a_smooth_background_is_no_concern_of_the_model() {
    let frame = observation(0.02, 0.05, 11);
    let plain = fit(&[frame.clone().with_background(Some(2))], &request(Constraints::default()));
    let mut flowing = frame;
    for (v, r) in flowing.velocities.values_mut().iter_mut().flatten().zip(&flowing.positions) {
        *v += voronudge_geometry::Vector::new(3.0 - r.y + 0.2 * r.x * r.y, 0.7 * r.x - 0.1 * r.y * r.y);
    }
    let flowing = fit(&[flowing.with_background(Some(2))], &request(Constraints::default()));
    for quantity in FitParameter::ALL {
        let (a, b) = (plain.parameters.get(quantity), flowing.parameters.get(quantity));
        assert!((a.value - b.value).abs() < 1e-3 * a.standard_error, "{quantity:?}");
    }
    assert!((plain.objective - flowing.objective).abs() < 1e-3 * plain.objective);
    assert!((plain.expected_objective - (72.0 - 12.0 - 4.0)).abs() < 1e-9);
}
