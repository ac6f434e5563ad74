//! Cells that were not detected before their track begins or after it ends.
//!
//! Cells come into a field over its rim, and a tissue gains and loses some by division and extrusion. A track that begins elsewhere,
//! with room for its cell where that must have been a frame before, is that of a cell which was not detected there. Without it the
//! polygons of its neighbours reach into its place, and their centroids with them.

use super::movie::Movie;
use super::neighbours::Motion;
use super::states::{Instant, instants};
use crate::Error;
use std::collections::BTreeSet;
use voronudge_geometry::{CellPolygon, Tessellation, Vector, Visibility};

/// Steps from where a cell is predicted to the centre of the place that the others leave.
const STEPS: usize = 3;

/// Least area of that place, in units of ℓ₀² and of the area that the cell has where it was seen: a cell put between others that are all
/// there gets less.
const LEAST_AREA: f64 = 0.4;
const LEAST_SHARE: f64 = 0.6;

/// A place of a cell in the frame next to those of its track.
#[derive(Debug, Clone, Copy)]
struct Unseen {
    track: usize,
    frame: usize,
    place: Vector<f64>,
    /// Area of the cell in the frame before or after.
    area: f64,
}

/// Lets the cells be where their tracks have not begun yet or have ended, frame by frame, as far as there is room for them. Positions in
/// units of ℓ₀.
///
/// # Errors
/// [`Error::Geometry`].
pub(super) fn lengthen(mut movie: Movie) -> Result<Movie, Error> {
    // Tracks and the frames in which there is no room for them.
    let mut without: BTreeSet<(usize, usize)> = BTreeSet::new();
    for _ in 1..movie.frames() {
        let mut put: Vec<Vec<Unseen>> = vec![Vec::new(); movie.frames()];
        for unseen in further(&movie)? {
            let Unseen { track, frame, place, .. } = unseen;
            if without.contains(&(track, frame)) {
                continue;
            }
            if movie.taken_by(frame, place).is_some() {
                without.insert((track, frame));
            } else {
                movie.tracks[track].lengthen(frame, place);
                put[frame].push(unseen);
            }
        }
        if put.iter().all(Vec::is_empty) {
            break;
        }
        for own in put.into_iter().filter(|own| !own.is_empty()) {
            for unseen in settle(&mut movie, &own)? {
                movie.tracks[unseen.track].shorten(unseen.frame);
                without.insert((unseen.track, unseen.frame));
            }
        }
    }
    Ok(movie)
}

/// Where cells should be in the frames next to those of their tracks. A cell whose polygon is certain is not about to leave the field.
fn further(movie: &Movie) -> Result<Vec<Unseen>, Error> {
    let last = movie.frames() - 1;
    let motions: Vec<Motion<'_>> = (0..last).map(|frame| Motion::new(movie, frame)).collect();
    let mut found = Vec::new();
    let mut polygon = CellPolygon::default();
    for (frame, instant) in instants(movie)?.iter().enumerate() {
        let Instant { tracks, cells, .. } = instant;
        for (cell, track) in tracks.iter().enumerate() {
            let track = *track as usize;
            let (begins, ends) = (movie.tracks[track].first == frame, movie.tracks[track].end() == frame + 1);
            let is_certain =
                matches!(cells.visibility[cell], Visibility::Counted | Visibility::NextToUncertain);
            let Some(r) = movie.near(track, frame).filter(|_| is_certain && (begins || ends)) else {
                continue;
            };
            polygon.fill(&cells.tessellation, &cells.positions, cell);
            let area = polygon.shape().area;
            if begins && frame > 0 {
                let place = r - motions[frame - 1].around(r, None);
                found.push(Unseen { track, frame: frame - 1, place, area });
            }
            if ends && frame < last {
                let place = r + motions[frame].around(r, None);
                found.push(Unseen { track, frame: frame + 1, place, area });
            }
        }
    }
    Ok(found)
}

/// Moves the cells that were put into a frame to the centres of their polygons. Returns those whose polygon is too small.
fn settle(movie: &mut Movie, put: &[Unseen]) -> Result<Vec<Unseen>, Error> {
    let Some(frame) = put.first().map(|unseen| unseen.frame) else { return Ok(Vec::new()) };
    let mut polygon = CellPolygon::default();
    let mut small = Vec::new();
    for step in 0..=STEPS {
        let (tracks, positions): (Vec<usize>, Vec<Vector<f64>>) =
            movie.present(frame).filter_map(|track| Some((track, movie.near(track, frame)?))).unzip();
        let tessellation = Tessellation::new(&positions, movie.domain)
            .map_err(|source| Error::Geometry { frame, source })?;
        for unseen in put {
            let Ok(cell) = tracks.binary_search(&unseen.track) else { continue };
            let is_closed = tessellation.is_closed(cell);
            if is_closed {
                polygon.fill(&tessellation, &positions, cell);
            }
            if step < STEPS && is_closed {
                movie.tracks[unseen.track].put(frame, positions[cell] + polygon.centroid());
            }
            let least = LEAST_AREA.max(LEAST_SHARE * unseen.area);
            if step == STEPS && !(is_closed && polygon.shape().area >= least) {
                small.push(*unseen);
            }
        }
    }
    Ok(small)
}
