//! Frames measured in ways that nobody declares.

use super::*;
use crate::sample::{COEFFICIENTS, cells, flow};
use crate::{Constraints, CrossValidation, Inference, KnownNoise, infer};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use voronudge_geometry::{CellPolygon, FieldOfView, Tessellation, Vector};
use voronudge_model::{Model, base_terms, velocities};

/// The tissue of the samples with positions at a share of the way to the centroids, with noise.
fn frame(share: f64, seed: u64) -> Observation {
    let (positions, domain) = cells();
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let terms = base_terms(1.0);
    let v = velocities(&tessellation, &positions, &Model::with_coefficients(&terms, &COEFFICIENTS));
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut noisy = |v: Vector<f64>, sigma: f64| {
        let normal = Normal::new(0.0, sigma).unwrap();
        v + Vector::new(normal.sample(&mut rng), normal.sample(&mut rng))
    };
    let mut polygon = CellPolygon::default();
    let measured = (0..positions.len())
        .map(|cell| {
            polygon.fill(&tessellation, &positions, cell);
            noisy(positions[cell] + polygon.centroid() * share, 0.01)
        })
        .collect();
    let velocities: Vec<_> = v.iter().map(|v| Some(noisy(*v, 0.03))).collect();
    Observation::new(0, measured, velocities, domain, FieldOfView::default()).unwrap()
}

fn request() -> Request {
    Request {
        noise: KnownNoise { position: Some(0.01), velocity: Some(0.03) },
        cross_validation: CrossValidation::Skipped,
        ..Request::new(Constraints::fixed([(FitParameter::AreaElasticity, COEFFICIENTS[0])]))
    }
}

fn measured(frames: &[Observation], known: KnownMeasurement) -> (Vec<Observation>, Measurement) {
    measure(frames, &request(), &known, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn fit(frames: &[Observation]) -> Inference {
    infer(frames, &request(), &mut |_| ControlFlow::Continue(())).unwrap()
}

/// By how many standard errors K_P α is off.
fn off(found: &Inference) -> f64 {
    let estimate = found.parameters.chiral_coefficient;
    (estimate.value - COEFFICIENTS[3]) / estimate.standard_error
}

#[test]
fn centroids_are_told_from_sites() {
    let sites = [frame(0.0, 1)];
    let (same, measurement) = measured(&sites, KnownMeasurement::default());
    assert_eq!(measurement.share.value, 0.0);
    let interval = measurement.share.interval.unwrap();
    assert!(interval[0] == 0.0 && interval[1] < 0.5, "{interval:?}");
    assert_eq!(same[0].positions, sites[0].positions);
    let centroids = [frame(1.0, 2)];
    let (moved, measurement) = measured(&centroids, KnownMeasurement::default());
    assert_eq!(measurement.share.value, 1.0, "{:?}", measurement.share);
    let (wrong, right) = (fit(&centroids), fit(&moved));
    assert!(off(&right).abs() < 3.0, "{}", off(&right));
    assert!(off(&wrong).abs() > 2.0 * off(&right).abs(), "{} {}", off(&wrong), off(&right));
    let stated = measured(&centroids, KnownMeasurement { share: Some(1.0), ..KnownMeasurement::default() });
    assert_eq!(stated.0[0].positions, moved[0].positions);
    assert_eq!(stated.1.share.interval, None);
}

/// A point between is neither, and its uncertainty is that of the coefficients too.
#[test]
fn a_share_between_widens_the_intervals() {
    let frames = [frame(0.5, 3)];
    let (found, measurement) = measured(&frames, KnownMeasurement::default());
    let share = measurement.share;
    let interval = share.interval.unwrap();
    assert!(interval[0] <= 0.5 && 0.5 <= interval[1], "{share:?}");
    if share.value > 0.0 && share.value < 1.0 {
        let known = [frames[0].clone().with_positions_at(share.value).unwrap()];
        let error = |frames: &[Observation]| fit(frames).parameters.chiral_coefficient.standard_error;
        assert!(error(&found) > error(&known));
    }
}

#[test]
fn widths_of_windows_are_found() {
    for (kind, width) in
        [(WindowKind::Square, 1.4), (WindowKind::Gaussian, 0.6), (WindowKind::GaussianArea, 0.4)]
    {
        let truth = Window { kind, width };
        let kind_alone = KnownMeasurement { share: Some(0.0), kind: Some(kind), width: None };
        let other =
            Window { kind, width: kind.usual_width(&Grid::new([0.3, 0.4], [1.0, 1.0], [6, 6]).unwrap()) };
        let blurred = [flow(truth).with_window(other)];
        let (frames, measurement) = measured(&blurred, kind_alone);
        let Determined { value, interval } = measurement.width.unwrap();
        let [low, high] = interval.unwrap();
        assert!(
            (value / width - 1.0).abs() < 0.05 && low < width && width < high,
            "{kind:?} {value} {interval:?}"
        );
        let found = fit(&frames).parameters.chiral_coefficient;
        assert!(found.covers(COEFFICIENTS[3]), "{kind:?} {found:?}");
        // The kind is told by the likelihood as well.
        let (_, measurement) = measured(&blurred, KnownMeasurement { kind: None, ..kind_alone });
        assert_eq!(measurement.kind, Some(kind), "{:?}", measurement.rivals);
    }
}
