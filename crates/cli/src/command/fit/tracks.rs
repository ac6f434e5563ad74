//! What came of tracks that were fitted.

use crate::failure::Failure;
use crate::problem::{Problem, Tracks};
use ndarray::Array3;
use voronudge_geometry::Vector;
use voronudge_infer::{Drift, Inference, Tracked};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_report::infer_report::TracksReport;

/// For the report.
pub(crate) fn report(
    prepared: &Problem,
    tracks: &Tracks,
    result: &Inference,
    tracked: &Tracked,
) -> TracksReport {
    let movie = &tracks.movie;
    let scale = &prepared.scale;
    let frames = movie.frames();
    let named: Vec<_> = movie.tracks.iter().filter(|track| !track.names.is_empty()).collect();
    TracksReport {
        tracks: named.len(),
        cut: tracks.cut,
        joined: tracks.joined,
        gaps: named.iter().map(|track| track.gaps()).sum(),
        begun: named.iter().filter(|track| track.first > 0).count(),
        ended: named.iter().filter(|track| track.end() < frames).count(),
        substeps: tracked.integration.substeps,
        order: tracked.integration.order,
        integration_error: tracked.integration.error,
        sigma_r: result.noise.position,
        sigma_d: result.noise.velocity * movie.interval(),
        drifts: match movie.drift {
            Drift::None => Vec::new(),
            Drift::PerInterval => {
                tracked.drifts.iter().map(|d| [d.x * scale.length, d.y * scale.length]).collect()
            }
        },
    }
}

/// Writes the trajectories (frames, cells, 2), each in the column of the first name of its track; the name of the file begins with `prefix`.
pub(crate) fn write(
    out: &mut OutputDirectory,
    prefix: &str,
    data: &DataSet,
    (prepared, tracks): (&Problem, &Tracks),
    tracked: &Tracked,
) -> Result<(), Failure> {
    let movie = &tracks.movie;
    let flip = data.y_sign();
    let mut all = Array3::from_elem((movie.frames(), data.cells(), 2), f64::NAN);
    for (frame, places) in tracked.trajectories.iter().enumerate() {
        for (track, place) in movie.tracks.iter().zip(places) {
            let Some(r) = place.map(|r: Vector<f64>| r * prepared.scale.length) else { continue };
            let Some(cell) = track.name(track.first) else { continue };
            all[(frame, cell, 0)] = r.x;
            all[(frame, cell, 1)] = flip * r.y;
        }
    }
    out.write_array(&format!("{prefix}trajectories.npy"), data.as_given(all).view())?;
    Ok(())
}
