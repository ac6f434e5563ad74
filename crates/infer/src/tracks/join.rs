//! Tracks that break and go on under another name.
//!
//! A track that ends and one that begins up to five frames later are one cell where its predicted place says so. The prediction follows the
//! mean motion of the neighbours; the scale s of its error is learned from the tracks that go on. A tracker loses the cells that move unlike
//! the others, so the error has the wide tails of a Student distribution with two degrees of freedom. With ρ tracks to a unit area that
//! begin in a frame, one that has nothing to do with the first is at a distance d from the prediction with density ρ, so joining gains
//!
//! ```text
//! log t₂(d) − log ρ = −2 log(1 + d² / 2s²) − log 2πs²ρ
//! ```
//!
//! Those joins are made, each end and each beginning at most once, that gain most together. Where the cell would have gone unseen meanwhile
//! there must be room for it.

use super::movie::{Movie, Track};
use super::neighbours::{Motion, log_density};
use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;
use pathfinding::undirected::connected_components::components;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use voronudge_geometry::Vector;

/// A track goes on after this many frames at most.
const LONGEST: usize = 5;

/// No two cells are nearer to each other than this, in units of ℓ₀, or hardly any.
const ROOM: f64 = 0.45;

/// Gains are counted in these parts of a unit.
const PARTS: f64 = 1e6;

/// Joins broken tracks; positions in units of ℓ₀. Returns how many joins were made.
pub(super) fn join(movie: &mut Movie) -> usize {
    let count = movie.tracks.len();
    // The next part of each track.
    let (mut next, mut taken) = (vec![None; count], vec![false; count]);
    for (end, begin) in assign(&gains(movie)) {
        next[end] = Some(begin);
        taken[begin] = true;
    }
    unite(movie, &next);
    taken.iter().filter(|taken| **taken).count()
}

/// Makes one track of those that follow each other: the next part of each, if it has one.
pub(super) fn unite(movie: &mut Movie, next: &[Option<usize>]) {
    let followers: BTreeSet<usize> = next.iter().copied().flatten().collect();
    let mut tracks: Vec<Track> = Vec::with_capacity(next.len() - followers.len());
    for head in (0..next.len()).filter(|track| !followers.contains(track)) {
        let mut whole = Track { first: 0, seen: Vec::new(), names: Vec::new() };
        let mut part = Some(head);
        while let Some(own) = part {
            let piece = &movie.tracks[own];
            whole.go_on(movie.domain, piece.first, piece.seen.iter().copied());
            whole.names.extend(&piece.names);
            part = next[own];
        }
        tracks.push(whole);
    }
    movie.tracks = tracks;
}

/// The tracks that end and those that begin later which may be one cell: both, and what joining them gains, in [`PARTS`].
fn gains(movie: &Movie) -> Vec<(usize, usize, i64)> {
    let frames = movie.frames();
    let motions: Vec<Motion<'_>> = (0..frames - 1).map(|frame| Motion::new(movie, frame)).collect();
    let begins: Vec<Vec<usize>> = (0..frames)
        .map(|frame| (0..movie.tracks.len()).filter(|track| movie.tracks[*track].first == frame).collect())
        .collect();
    let of_end = |end: usize| {
        let last = movie.tracks[end].end() - 1;
        let mut gains = Vec::new();
        let Some(from) = movie.tracks[end].at(last) else { return gains };
        // Where the cell should be. The squares of errors add up as those of a random walk.
        let (mut place, mut square) = (from, 0.0);
        for (frame, motion) in (last + 1..frames).zip(&motions[last..]).take(LONGEST) {
            place += motion.around(place, None);
            square += motion.square;
            for &begin in &begins[frame] {
                let Some(to) = movie.tracks[begin].at(frame) else { continue };
                let miss = movie.domain.shortest(to - place).norm_squared();
                let gain = ((log_density(miss, square) - motion.beginnings.ln()) * PARTS) as i64;
                if gain > 0 && has_room(movie, (last, from), (frame, to)) {
                    gains.push((end, begin, gain));
                }
            }
        }
        gains
    };
    (0..movie.tracks.len()).into_par_iter().flat_map_iter(of_end).collect()
}

/// Whether a cell that was not seen between two frames can have been there: no other is in its place.
fn has_room(movie: &Movie, (first, from): (usize, Vector<f64>), (last, to): (usize, Vector<f64>)) -> bool {
    let way = movie.domain.shortest(to - from);
    (first + 1..last).all(|frame| {
        let share = (frame - first) as f64 / (last - first) as f64;
        movie.nearest(frame, from + way * share).is_none_or(|(distance, _)| distance > ROOM)
    })
}

/// The pairs that gain most together, each end and each beginning in one at most.
fn assign(gains: &[(usize, usize, i64)]) -> Vec<(usize, usize)> {
    let gain_of: BTreeMap<(usize, usize), i64> =
        gains.iter().map(|gain| ((gain.0, gain.1), gain.2)).collect();
    let mut pairs = Vec::new();
    // Ends that have no beginning in common do not depend on each other.
    let linked: Vec<Vec<Side>> =
        gains.iter().map(|gain| vec![Side::End(gain.0), Side::Beginning(gain.1)]).collect();
    for group in components(&linked) {
        let (mut ends, mut begins) = (Vec::new(), Vec::new());
        for side in group.into_iter().collect::<BTreeSet<_>>() {
            match side {
                Side::End(track) => ends.push(track),
                Side::Beginning(track) => begins.push(track),
            }
        }
        let gain = |end: usize, begin: usize| gain_of.get(&(end, begin)).copied().unwrap_or(0);
        // The method wants no more rows than columns.
        let wide = ends.len() <= begins.len();
        let matrix = match wide {
            true => Matrix::from_fn(ends.len(), begins.len(), |(i, j)| gain(ends[i], begins[j])),
            false => Matrix::from_fn(begins.len(), ends.len(), |(j, i)| gain(ends[i], begins[j])),
        };
        let (_, partner) = kuhn_munkres(&matrix);
        let paired = partner.into_iter().enumerate().map(|(row, column)| match wide {
            true => (ends[row], begins[column]),
            false => (ends[column], begins[row]),
        });
        pairs.extend(paired.filter(|(end, begin)| gain(*end, *begin) > 0));
    }
    pairs
}

/// A track as one side of a join.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Side {
    End(usize),
    Beginning(usize),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::Drift;
    use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, honeycomb};

    /// A honeycomb that flows through a periodic box, so that tracks cross its sides.
    fn flowing(frames: usize) -> (Vec<Vec<Option<Vector<f64>>>>, Domain) {
        let (cells, lengths) = honeycomb(6, 6);
        let cell_box = PeriodicBox::new(lengths).unwrap();
        let moved = |r: &Vector<f64>, k: usize, cell: usize| {
            let wobble = Vector::new(0.02 * (cell as f64).sin(), 0.02 * (2.0 * cell as f64).cos());
            Some(cell_box.wrap(r + (Vector::new(0.3, 0.1) + wobble) * k as f64))
        };
        let frame = |k: usize| cells.iter().enumerate().map(|(c, r)| moved(r, k, c)).collect();
        ((0..frames).map(frame).collect(), Domain::Periodic(cell_box))
    }

    fn movie(frames: &[Vec<Option<Vector<f64>>>], domain: Domain) -> Movie {
        let times = (0..frames.len()).map(|k| k as f64).collect();
        Movie::new(times, frames, domain, FieldOfView::default(), Drift::None).unwrap()
    }

    #[test]
    fn broken_tracks_are_joined_and_others_are_not() {
        let (mut frames, domain) = flowing(5);
        let whole = movie(&frames, domain);
        // Cell 3 goes on as 36, cell 8 after a frame in which it is not seen as 37; cell 20 ends, and 38 begins elsewhere.
        for (k, frame) in frames.iter_mut().enumerate() {
            let [three, eight] = [frame[3], frame[8]];
            frame.extend([None, None, None]);
            if k >= 2 {
                (frame[36], frame[3]) = (three, None);
                frame[8] = None;
                frame[20] = None;
                frame[38] = frame[30].map(|r| r + Vector::new(0.45, 0.2));
            }
            if k >= 3 {
                frame[37] = eight;
            }
        }
        let mut broken = movie(&frames, domain);
        assert_eq!(join(&mut broken), 2);
        assert_eq!(broken.tracks.len(), 37);
        let named = |name: usize| broken.tracks.iter().find(|t| t.names.iter().any(|n| n.1 == name)).unwrap();
        assert_eq!(named(3).names, [(0, 3), (2, 36)]);
        assert_eq!(named(8).names, [(0, 8), (3, 37)]);
        assert_eq!((named(20).names.len(), named(38).names.len()), (1, 1));
        assert_eq!((named(3).name(1), named(3).name(4)), (Some(3), Some(36)));
        assert_eq!((named(3).gaps(), named(8).gaps()), (0, 1));
        for k in 0..5 {
            let (place, expected) = (named(3).at(k).unwrap(), whole.tracks[3].at(k).unwrap());
            assert!(domain.shortest(place - expected).norm() < 1e-12);
            // In one piece.
            assert!(k == 0 || (place - named(3).at(k - 1).unwrap()).norm() < 1.0);
        }
    }
}
