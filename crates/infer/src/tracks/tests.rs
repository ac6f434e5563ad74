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

#[test]
#[ignore]
fn explore() {
    let env =
        |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    for seed in env("SEED", 1.0) as u64..(env("SEED", 1.0) + env("SETS", 1.0)) as u64 {
        let (movie, truth) = Filmed {
            size: [env("N", 144.0) as usize, env("F", 4.0) as usize],
            step: env("STEP", 0.19),
            error: env("SIGMA", 0.02),
            seed,
        }
        .movie();
        let begin = std::time::Instant::now();
        let constraints =
            Constraints { fixed: [(Quantity::AreaElasticity, 0.0)].into(), ..Constraints::default() };
        let request = Request::new(if env("KA", 0.0) > 0.0 { Constraints::default() } else { constraints });
        let (found, tracked) = infer_tracks(&movie, &request, &mut |_| ControlFlow::Continue(())).unwrap();
        let p = &found.parameters;
        println!(
            "seed {seed} KPa {:+.2} % (z {:+.1}) P0 {:+.2} % (z {:+.1}, covers {}) alpha {:.3} naive KPa {:+.1} % P0 {:.2}; {:?} {:?} {:?} steps {} {:?} {:.1} s",
            100.0 * (p.chiral_coefficient.value / truth - 1.0),
            (p.chiral_coefficient.value - truth) / p.chiral_coefficient.standard_error,
            100.0 * (p.preferred_perimeter.value / 4.0 - 1.0),
            (p.preferred_perimeter.value - 4.0) / p.preferred_perimeter.standard_error,
            p.preferred_perimeter.covers(4.0),
            p.chirality.value,
            100.0 * (found.naive.chirality * found.naive.perimeter_elasticity / truth - 1.0),
            found.naive.preferred_perimeter,
            found.noise,
            tracked.integration,
            found.nmse,
            found.steps,
            found.doubts,
            begin.elapsed().as_secs_f64()
        );
    }
}
