use super::infer_tracks;
use super::sample::{Filmed, TRUTH};
use crate::{Constraints, Quantity, Request};
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
