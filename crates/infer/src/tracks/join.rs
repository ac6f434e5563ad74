//! Tracks that break and go on under another name.
//!
//! A track that ends and one that begins up to five frames later are one cell where its predicted place says so. The prediction follows the
//! mean motion of the neighbours; the scale s of its error is learned from the tracks that go on. A tracker loses the cells that move unlike
//! the others, so the error has the wide tails of a Student distribution with two degrees of freedom. If a share λ of the tracks that end
//! does so for good, and ρ tracks to a unit area begin in a frame that no other goes on as, joining two at a distance d from the prediction gains
//!
//! ```text
//! log (1 − λ) t₂(d) − log λρ = −2 log(1 + d² / 2s²) − log 2πs² − log ρλ / (1 − λ)
//! ```
//!
//! Those joins are made, each end and each beginning at most once, that gain most together. Where the cell would have gone unseen meanwhile
//! there must be room for it. λ and ρ are not known: at first nothing is said of ends, and each beginning is one that may have nothing to do with
//! any, and then both are counted of what was not joined, until the joins are the same again. A cell that comes back a third of its size from where its
//! neighbours went is otherwise two, each put where no other is, side by side in the room of one.

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

/// A cell is not joined to one farther than this from where it should be, in units of ℓ₀: it would have changed places with a neighbour.
const REACH: f64 = 0.75;

/// The shares of ends and beginnings are counted anew this often, if the joins do not settle before.
const ROUNDS: usize = 8;

/// Gains are counted in these parts of a unit.
const PARTS: f64 = 1e6;

impl Movie {
    /// Joins tracks that break and go on under another name; positions in units of ℓ₀. Returns how many joins were made.
    ///
    /// A track that ends and one that begins a frame or two later are taken for one cell where that is more likely than two that are
    /// there by chance, given how well the motion of its neighbours predicts that of a cell.
    pub fn join(&mut self) -> usize {
        let count = self.tracks.len();
        let pairs = pairs(self);
        let mut joins = assign(&gains(&pairs, |pair| -pair.beginnings.ln()));
        for _ in 1..ROUNDS {
            let odds = Odds::left_by(self, &joins);
            let now = assign(&gains(&pairs, |_| odds.log_of_a_join()));
            let is_settled = now == joins;
            joins = now;
            if is_settled {
                break;
            }
        }
        // The next part of each track.
        let mut next = vec![None; count];
        for &(end, begin) in &joins {
            next[end] = Some(begin);
        }
        unite(self, &next);
        joins.len()
    }
}

/// Makes one track of those that follow each other: the next part of each, if it has one.
pub(super) fn unite(movie: &mut Movie, next: &[Option<usize>]) {
    let followers: BTreeSet<usize> = next.iter().copied().flatten().collect();
    let mut tracks: Vec<Track> = Vec::with_capacity(next.len() - followers.len());
    for head in (0..next.len()).filter(|track| !followers.contains(track)) {
        let mut whole = Track { first: 0, seen: Vec::new(), names: Vec::new(), label: None };
        let mut part = Some(head);
        while let Some(own) = part {
            let piece = &movie.tracks[own];
            whole.go_on(movie.domain, piece.first, piece.seen.iter().copied());
            whole.names.extend(&piece.names);
            whole.label = whole.label.or(piece.label);
            part = next[own];
        }
        tracks.push(whole);
    }
    movie.tracks = tracks;
}

/// A track that ends and one that begins later which may be one cell.
#[derive(Debug, Clone, Copy)]
struct Pair {
    end: usize,
    begin: usize,
    /// Log density of the beginning, if it is one cell.
    log_density: f64,
    /// Tracks that begin in its frame, to a unit area.
    beginnings: f64,
}

/// All tracks that end with those that begin later within reach.
fn pairs(movie: &Movie) -> Vec<Pair> {
    let frames = movie.frames();
    let motions: Vec<Motion<'_>> = (0..frames - 1).map(|frame| Motion::new(movie, frame)).collect();
    let begins: Vec<Vec<usize>> = (0..frames)
        .map(|frame| (0..movie.tracks.len()).filter(|track| movie.tracks[*track].first == frame).collect())
        .collect();
    let of_end = |end: usize| {
        let last = movie.tracks[end].end() - 1;
        let mut pairs = Vec::new();
        let Some(from) = movie.tracks[end].at(last) else { return pairs };
        // Where the cell should be. The squares of errors add up as those of a random walk.
        let (mut place, mut square) = (from, 0.0);
        for (frame, motion) in (last + 1..frames).zip(&motions[last..]).take(LONGEST) {
            place += motion.around(place, None);
            square += motion.square;
            for &begin in &begins[frame] {
                let Some(to) = movie.tracks[begin].at(frame) else { continue };
                let miss = movie.domain.shortest(to - place).norm_squared();
                if miss <= REACH * REACH && has_room(movie, (last, from), (frame, to)) {
                    let log_density = log_density(miss, square);
                    pairs.push(Pair { end, begin, log_density, beginnings: motion.beginnings });
                }
            }
        }
        pairs
    };
    (0..movie.tracks.len()).into_par_iter().flat_map_iter(of_end).collect()
}

/// How often tracks end, and begin, that nothing joins.
#[derive(Debug, Clone, Copy)]
struct Odds {
    /// Share λ of the ends before the last frame.
    lost: f64,
    /// Beginnings ρ after the first frame, to a unit area and frame.
    beginnings: f64,
}

impl Odds {
    /// What the joins leave. One more of each is counted than there are, so that none are not taken for impossible.
    fn left_by(movie: &Movie, joins: &[(usize, usize)]) -> Self {
        let frames = movie.frames();
        let ends = movie.tracks.iter().filter(|track| track.end() < frames).count();
        let begins = movie.tracks.iter().filter(|track| track.first > 0).count();
        let cells: usize = (1..frames).map(|frame| movie.present(frame).count()).sum();
        let left = |of: usize| (of.saturating_sub(joins.len()) + 1) as f64;
        Self { lost: left(ends) / (ends + 2) as f64, beginnings: left(begins) / cells.max(1) as f64 }
    }

    /// log (1 − λ) / λρ, which a join gains beside the density.
    fn log_of_a_join(&self) -> f64 {
        ((1.0 - self.lost) / (self.lost * self.beginnings)).ln()
    }
}

/// What the joins gain that gain anything, in [`PARTS`]: the density of each, and what is known beside it.
fn gains(pairs: &[Pair], beside: impl Fn(&Pair) -> f64) -> Vec<(usize, usize, i64)> {
    let gain = |pair: &Pair| (pair.end, pair.begin, ((pair.log_density + beside(pair)) * PARTS) as i64);
    pairs.iter().map(gain).filter(|(_, _, gain)| *gain > 0).collect()
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
        assert_eq!(broken.join(), 2);
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

    /// A cell that is lost and comes back half a cell from where its neighbours went is one with itself where tracks break often and all go on, and
    /// is left in two where nothing says that they do.
    #[test]
    fn what_is_known_of_other_breaks_tells_of_a_doubtful_one() {
        let joined = |breaks: usize| {
            let (mut frames, domain) = flowing(5);
            for (k, frame) in frames.iter_mut().enumerate() {
                let aside = frame[8].filter(|_| k >= 3).map(|r| r - Vector::new(0.4, 0.1));
                frame[8] = frame[8].filter(|_| k < 2);
                frame.push(aside);
                for cell in 20..20 + breaks {
                    let goes_on = frame[cell].filter(|_| k >= 2);
                    frame[cell] = frame[cell].filter(|_| k < 2);
                    frame.push(goes_on);
                }
            }
            let mut broken = movie(&frames, domain);
            (broken.join(), broken.tracks.len())
        };
        assert_eq!(joined(12), (13, 36));
        assert_eq!(joined(1), (1, 37));
    }
}
