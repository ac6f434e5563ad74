//! Cells that were not detected before their track begins or after it ends.
//!
//! Cells come into a field over its rim, and a tissue gains and loses some by division and extrusion. A track that begins elsewhere,
//! with room for its cell where that must have been a frame before, is that of a cell which was not detected there. Without it the
//! polygons of its neighbours reach into its place, and their centroids with them.

use super::movie::Movie;
use super::neighbours::Motion;
use super::states::{Instant, instants};
use crate::Error;
use voronudge_geometry::{Vector, Visibility};

/// A place of a cell that was not detected there.
struct Unseen {
    track: usize,
    frame: usize,
    place: Vector<f64>,
}

/// Lets the cells be where their tracks have not begun yet or have ended, frame by frame, as far as there is room for them. Positions in
/// units of ℓ₀.
///
/// # Errors
/// [`Error::Geometry`].
pub(super) fn lengthen(mut movie: Movie) -> Result<Movie, Error> {
    for _ in 1..movie.frames() {
        let mut longer = 0;
        for Unseen { track, frame, place } in further(&movie)? {
            if movie.taken_by(frame, place).is_none() {
                movie.tracks[track].lengthen(frame, place);
                longer += 1;
            }
        }
        if longer == 0 {
            break;
        }
    }
    Ok(movie)
}

/// Where cells should be in the frames next to those of their tracks. A cell whose polygon is certain is not about to leave the field.
fn further(movie: &Movie) -> Result<Vec<Unseen>, Error> {
    let last = movie.frames() - 1;
    let motions: Vec<Motion<'_>> = (0..last).map(|frame| Motion::new(movie, frame)).collect();
    let mut found = Vec::new();
    for (frame, instant) in instants(movie)?.iter().enumerate() {
        let Instant { tracks, cells, .. } = instant;
        for (track, visibility) in tracks.iter().zip(&cells.visibility) {
            let track = *track as usize;
            let is_certain = matches!(visibility, Visibility::Counted | Visibility::NextToUncertain);
            let Some(r) = movie.near(track, frame).filter(|_| is_certain) else { continue };
            let own = &movie.tracks[track];
            if own.first == frame && frame > 0 {
                let place = r - motions[frame - 1].around(r, None);
                found.push(Unseen { track, frame: frame - 1, place });
            }
            if own.end() == frame + 1 && frame < last {
                let place = r + motions[frame].around(r, None);
                found.push(Unseen { track, frame: frame + 1, place });
            }
        }
    }
    Ok(found)
}
