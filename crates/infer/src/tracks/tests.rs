use super::sample::{Filmed, TRUTH};
use super::{infer_tracks, measure_tracks};
use crate::{Activity, Constraints, Drives, FitParameter, KnownMeasurement, Request};
use std::ops::ControlFlow;
use voronudge_simulate::Driving;

/// Cells that move a fifth of their size from frame to frame: parameters within their intervals, where differences miss a third.
#[test]
fn large_steps_do_not_bias_the_parameters() {
    let (movie, chiral) = Filmed { size: [100, 4], step: 0.19, error: 0.02, seed: 3 }.movie();
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
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

/// Where the model is right, the error of motions held out is what noise alone leaves: of the motions themselves and of the forces at measured places,
/// which make half of it here.
#[test]
fn errors_held_out_are_those_of_noise() {
    for seed in [3, 4] {
        let (movie, _) = Filmed { size: [100, 5], step: 0.06, error: 0.02, seed }.movie();
        let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
        let (found, _) =
            infer_tracks(&movie, &Request::new(constraints), &mut |_| ControlFlow::Continue(())).unwrap();
        let [held_out, spread] = found.nmse.cross_validated.unwrap();
        assert!((held_out - found.nmse.noise_floor).abs() < 3.0 * spread, "{:?}", found.nmse);
    }
}

/// Centroids in a movie are told from sites, and do not bias the parameters.
#[test]
#[ignore = "slow"]
fn centroids_are_told_from_sites() {
    let filmed = Filmed { size: [144, 4], step: 0.1, error: 0.01, seed: 4 };
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
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

/// Motions of centroids are predicted as they are measured, though the places that lead back from centroids predict little.
#[test]
fn motions_of_centroids_are_predicted() {
    let filmed = Filmed { size: [100, 4], step: 0.1, error: 0.005, seed: 4 };
    let movie = filmed.movie_of_centroids().0.with_positions_at(1.0);
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
    let (found, _) =
        infer_tracks(&movie, &Request::new(constraints), &mut |_| ControlFlow::Continue(())).unwrap();
    let [held_out, _] = found.nmse.cross_validated.unwrap();
    assert!(held_out < 3.0 * found.nmse.noise_floor, "{:?}", found.nmse);
    assert!(held_out < 0.3 * found.nmse.un_nudged, "{:?}", found.nmse);
}

fn crawling() -> Request {
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]);
    Request { activity: Activity::Polarity, ..Request::new(constraints) }
}

/// Cells that crawl: what they move by of themselves is told from what the model does to them, and does not bias it.
#[test]
fn polarities_are_told_from_forces() {
    let filmed = Filmed { size: [100, 6], step: 0.1, error: 0.01, seed: 5 };
    let (movie, [chiral, speed, rate]) = filmed.movie_of_crawling(1.0, 1.0);
    let (found, tracked) = infer_tracks(&movie, &crawling(), &mut |_| ControlFlow::Continue(())).unwrap();
    let p = &found.parameters;
    assert!((p.chiral_coefficient.value / chiral - 1.0).abs() < 0.04, "{:?} {chiral}", p.chiral_coefficient);
    assert!((p.preferred_perimeter.value / TRUTH[0] - 1.0).abs() < 0.03, "{:?}", p.preferred_perimeter);
    assert!((found.noise.position / 0.01 - 1.0).abs() < 0.2, "{:?}", found.noise);
    let polarity = tracked.polarity.unwrap();
    assert!((polarity.speed / speed - 1.0).abs() < 0.15, "{polarity:?} {speed}");
    let within = |[low, high]: [f64; 2], value: f64| low < value && value < high;
    assert!(within(polarity.speed_interval, speed), "{polarity:?} {speed}");
    assert!(polarity.rate_interval.is_some_and(|ends| within(ends, rate)), "{polarity:?} {rate}");
    let of_cells: Vec<_> = found.frames[2].polarities.iter().flatten().collect();
    assert_eq!(of_cells.len(), 100);
    let mean = of_cells.iter().map(|p| p.norm_squared()).sum::<f64>() / 100.0;
    assert!((0.5..1.1).contains(&(mean / speed.powi(2))), "{mean} {speed}");
}

/// Of cells that crawl, each by itself, no alignment is reported. (Of those that align it is: see the tests of the search for effects.)
#[test]
#[ignore = "slow"]
fn no_alignment_is_made_of_crawling() {
    let request = Request { activity: Activity::Alignment, ..crawling() };
    let filmed = Filmed { size: [144, 6], step: 0.15, error: 0.01, seed: 5 };
    let (movie, [chiral, speed, _]) = filmed.movie_of_crawling(1.0, 1.0);
    let (found, tracked) = infer_tracks(&movie, &request, &mut |_| ControlFlow::Continue(())).unwrap();
    let own = found.parameters.chiral_coefficient;
    assert!((own.value / chiral - 1.0).abs() < 0.03, "{own:?} {chiral}");
    let polarity = tracked.polarity.unwrap();
    let [low, high] = polarity.speed_interval;
    assert!((low..high).contains(&speed), "{polarity:?} {speed}");
    let alignment = polarity.alignment.unwrap();
    assert!(alignment.interval[0] == 0.0 && alignment.interval[1] < speed, "{alignment:?}");
    assert!(alignment.evidence < 4.0, "{alignment:?}");
}

/// Cells whose polarity turns away from contacts and along the forces: both coefficients are found; of cells that only crawl they are none.
#[test]
#[ignore = "slow"]
fn drives_of_polarities_are_found() {
    let drives = Drives { contact_inhibition: true, velocity_alignment: true };
    let request = Request { drives, ..crawling() };
    let filmed = Filmed { size: [100, 7], step: 0.15, error: 0.01, seed: 5 };
    let crawling = Driving { speed: 1.0, rotational_diffusion: 2.0, free_speed: true, ..Driving::default() };
    for [b, kappa] in [[0.0, 0.0], [25.0, 0.5]] {
        let driving = Driving { contact_inhibition: b, velocity_alignment: kappa, ..crawling };
        let (movie, [chiral, unit, _]) = filmed.movie_of_driven(driving);
        let (found, tracked) = infer_tracks(&movie, &request, &mut |_| ControlFlow::Continue(())).unwrap();
        let own = found.parameters.chiral_coefficient;
        assert!((own.value / chiral - 1.0).abs() < 0.03, "{own:?} {chiral}");
        let polarity = tracked.polarity.unwrap();
        let truth = [b * unit * unit, kappa * unit];
        let found = [polarity.contact_inhibition, polarity.velocity_alignment].map(Option::unwrap);
        for (drive, truth) in found.into_iter().zip(truth) {
            let [low, high] = drive.interval;
            assert!(low < truth && truth < high, "{drive:?} {truth}");
            assert_eq!(drive.evidence > 6.6, truth > 0.0, "{drive:?} {truth}");
        }
    }
}

/// Of cells that do not crawl no polarity is reported.
#[test]
fn no_polarity_is_made_of_errors() {
    let (movie, chiral) = Filmed { size: [100, 5], step: 0.1, error: 0.02, seed: 6 }.movie();
    let (found, tracked) = infer_tracks(&movie, &crawling(), &mut |_| ControlFlow::Continue(())).unwrap();
    let own = found.parameters.chiral_coefficient;
    assert!((own.value / chiral - 1.0).abs() < 0.04, "{own:?} {chiral}");
    assert!((found.noise.position / 0.02 - 1.0).abs() < 0.15, "{:?}", found.noise);
    let polarity = tracked.polarity.unwrap();
    // Without a memory the speed is that of white noise: its upper end is loose.
    assert!(polarity.speed_interval[0] == 0.0 && polarity.speed_interval[1] < 0.8, "{polarity:?}");
    assert_eq!((polarity.rate_interval, polarity.evidence), (None, 0.0));
}
