//! Cells that were not detected before their track begins or after it ends.
//!
//! Cells come into a field over its rim, and a tissue gains and loses some by division and extrusion. A track that begins elsewhere,
//! with room for its cell where that must have been a frame before, is that of a cell which was not detected there. Without it the
//! polygons of its neighbours reach into its place, and their centroids with them.

use super::instants::{Instant, instants};
use super::join::unite;
use super::movie::Movie;
use super::neighbours::Motion;
use crate::Error;
use std::collections::BTreeSet;
use voronudge_geometry::{CellPolygon, Tessellation, Vector};

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

/// Lets the cells be where their tracks have not begun yet or have ended, frame by frame, as far as there is room for them. Tracks that
/// meet in a frame in which one of them is unseen are of one cell. Positions in units of ℓ₀.
///
/// # Errors
/// [`Error::Geometry`].
pub(super) fn lengthen(mut movie: Movie) -> Result<Movie, Error> {
    // Tracks and the frames in which there is no room for them.
    let mut without: BTreeSet<(usize, usize)> = BTreeSet::new();
    for _ in 1..movie.frames() {
        let mut put: Vec<Vec<Unseen>> = vec![Vec::new(); movie.frames()];
        let mut next: Vec<Option<usize>> = vec![None; movie.tracks.len()];
        for unseen in further(&movie)? {
            let Unseen { track, frame, place, .. } = unseen;
            if without.contains(&(track, frame)) {
                continue;
            }
            match movie.taken_by(frame, place) {
                None => {
                    movie.tracks[track].lengthen(frame, place);
                    put[frame].push(unseen);
                }
                Some(other) => {
                    without.insert((track, frame));
                    let met = meet(&movie, track, other, frame);
                    if let Some((first, then)) = met.filter(|(_, then)| !next.contains(&Some(*then))) {
                        let _ = next[first].get_or_insert(then);
                    }
                }
            }
        }
        for own in put.iter().filter(|own| !own.is_empty()) {
            for unseen in settle(&mut movie, own)? {
                movie.tracks[unseen.track].shorten(unseen.frame);
                without.insert((unseen.track, unseen.frame));
            }
        }
        if next.iter().any(Option::is_some) {
            unite(&mut movie, &next);
            without.clear();
        } else if put.iter().all(Vec::is_empty) {
            break;
        }
    }
    Ok(movie)
}

/// The earlier and the later of two tracks of which one would go on in a frame where the other, unseen, has its end.
fn meet(movie: &Movie, track: usize, other: usize, frame: usize) -> Option<(usize, usize)> {
    let [own, there] = [track, other].map(|number| &movie.tracks[number]);
    // What was found between the tracks has its own place among them.
    if own.names.is_empty() || there.names.is_empty() {
        return None;
    }
    let unseen = there.at(frame).is_none();
    if unseen && own.first == frame + 1 && there.end() == frame + 1 {
        return Some((other, track));
    }
    (unseen && own.end() == frame && there.first == frame).then_some((track, other))
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
            let is_certain = cells.visibility[cell].has_certain_polygon();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::Drift;
    use crate::tracks::objective::MovieObjective;
    use crate::tracks::rule::Rule;
    use crate::tracks::sample::Filmed;
    use crate::tracks::states::States;
    use crate::{CoefficientSpace, Constraints, NoiseLevels};
    use voronudge_geometry::FieldOfView;
    use voronudge_model::Structure;

    /// Cells that are not detected at first, at last, or twice at the end are put where they are; one that divides is not.
    #[test]
    fn undetected_ends_are_put_where_the_cells_are() {
        let (mut film, domain, _) = Filmed { size: [144, 5], step: 0.1, error: 0.01, seed: 4 }.film();
        let truth = film.clone();
        for (frame, cell) in [(0, 20), (0, 21), (4, 50), (3, 90), (4, 90)] {
            film[frame][cell] = None;
        }
        // Two daughters from the third frame on.
        for (frame, cells) in film.iter_mut().enumerate() {
            let mother = cells[120].filter(|_| frame >= 2);
            cells.push(mother.map(|r| r + Vector::new(0.2, 0.0)));
            cells.push(mother.map(|r| r - Vector::new(0.2, 0.0)));
            cells[120] = cells[120].filter(|_| frame < 2);
        }
        let times = (0..5).map(|frame| 0.1 * f64::from(frame)).collect();
        let movie = Movie::new(times, &film, domain, FieldOfView::default(), Drift::None).unwrap();
        let longer = lengthen(movie.clone()).unwrap();
        for (track, own) in longer.tracks.iter().enumerate() {
            let whole = (own.first, own.end()) == (0, 5);
            assert_eq!(whole, !(track == 120 || track >= 144), "{track}: {} to {}", own.first, own.end());
        }
        for (frame, cell) in [(0, 20), (0, 21), (4, 50), (3, 90), (4, 90)] {
            assert!(longer.tracks[cell].at(frame).is_none());
            let place = longer.near(cell, frame).unwrap();
            let miss = domain.shortest(place - truth[frame][cell].unwrap()).norm();
            assert!(miss < 0.3, "{cell} in {frame}: {miss}");
        }
        // They are held in the room that they have, and nothing else of the places is.
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let objective = MovieObjective {
            movie: &longer,
            states: &States::new(&longer).unwrap(),
            rule: Rule::Trapezoid,
            structure: &Structure::base(1.0),
            space: &space,
            levels: NoiseLevels { position: 0.01, velocity: 0.15 },
            memory: None,
        };
        let places = objective.states.start.len();
        let held = objective.stiffness().of_blocks[..places].to_vec();
        assert_eq!(held.iter().filter(|own| (**own - 0.25).abs() < 1e-12).count(), 5);
        assert_eq!(held.iter().filter(|own| **own == 0.0).count(), places - 5);
        // A gap goes on beyond the first frames.
        let gap = longer.beginning(4);
        assert_eq!((gap.tracks[90].end(), gap.tracks[90].at(3)), (4, None));
    }
}
