use super::sample::{Filmed, TRUTH};
use super::{infer_tracks, measure_tracks};
use crate::{Constraints, KnownMeasurement, Quantity, Request};
use std::ops::ControlFlow;

/// Cells that move a fifth of their size from frame to frame: parameters within their intervals, where differences miss a third.
#[test]
fn large_steps_do_not_bias_the_parameters() {
    let (movie, chiral) = Filmed { size: [100, 4], step: 0.19, error: 0.02, seed: 3 }.movie();
    let constraints =
        Constraints { fixed: [(Quantity::AreaElasticity, 0.0)].into(), ..Constraints::default() };
    let (found, tracked) =
        infer_tracks(&movie, &Request::new(constraints), &mut |_| ControlFlow::Continue(())).unwrap();
    let p = &found.parameters;
    let error = |value: f64, truth: f64| (value / truth - 1.0).abs();
    assert!(error(p.chiral_coefficient.value, chiral) < 0.03, "{:?} {chiral}", p.chiral_coefficient);
    assert!(p.preferred_perimeter.covers(TRUTH[0]), "{:?}", p.preferred_perimeter);
    assert!(error(p.preferred_perimeter.value, TRUTH[0]) < 0.03, "{:?}", p.preferred_perimeter);
    assert!(error(found.noise.position, 0.02) < 0.15, "{:?}", found.noise);
    assert!(found.doubts.is_empty() && found.nmse.cross_validated.is_some());
    assert_eq!((tracked.trajectories.len(), tracked.integration.order), (4, 4));
    assert!(tracked.integration.error < 0.2);
}

/// Centroids in a movie are told from sites, and do not bias the parameters.
#[test]
fn centroids_are_told_from_sites() {
    let filmed = Filmed { size: [144, 4], step: 0.1, error: 0.01, seed: 4 };
    let constraints =
        Constraints { fixed: [(Quantity::AreaElasticity, 0.0)].into(), ..Constraints::default() };
    let request = Request::new(constraints);
    let mut observe = |_: crate::Progress<'_>| ControlFlow::Continue(());
    for (share, (movie, chiral)) in [(0.0, filmed.movie()), (1.0, filmed.movie_of_centroids())] {
        let (movie, measurement) =
            measure_tracks(&movie, &request, &KnownMeasurement::default(), &mut observe).unwrap();
        assert_eq!(measurement.share.value, share, "{measurement:?}");
        let (found, _) = infer_tracks(&movie, &request, &mut observe).unwrap();
        let p = &found.parameters;
        assert!(
            (p.chiral_coefficient.value / chiral - 1.0).abs() < 0.03,
            "{:?} {chiral}",
            p.chiral_coefficient
        );
        assert!(p.preferred_perimeter.covers(TRUTH[0]), "{:?}", p.preferred_perimeter);
        assert!((found.noise.position / 0.01 - 1.0).abs() < 0.3, "{:?}", found.noise);
    }
}
