//! Tracks that break and go on under another name.
//!
//! A track that ends and one that begins a frame or two later are one cell where its predicted place says so. The prediction is the
//! mean motion of the neighbours; its error σ is learned from the tracks that go on. With one cell to a unit area, a cell that has nothing to
//! do with the first is at a distance d from the prediction with density 1, the same cell with the density of the error, so joining gains
//!
//! ```text
//! log N(d; 0, σ²) − log 1 = −d² / 2σ² − log 2πσ²
//! ```
//!
//! Those joins are made, each end and each beginning at most once, that gain most together.

use super::movie::{Movie, Track};
use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;
use voronudge_geometry::Vector;

/// A track goes on after this many frames at most.
const LONGEST: usize = 2;

/// Neighbours whose motion predicts that of a cell.
const NEIGHBOURS: usize = 6;

/// Gains are counted in these parts of a unit.
const PARTS: f64 = 1e6;

/// Smallest error of a prediction, in units of ℓ₀.
const SMALLEST_ERROR: f64 = 1e-3;

/// Joins broken tracks; positions in units of ℓ₀. Returns how many joins were made.
pub(super) fn join(movie: &mut Movie) -> usize {
    let count = movie.tracks.len();
    let frames = movie.frames();
    // The next part of each track.
    let (mut next, mut taken) = (vec![None; count], vec![false; count]);
    for frame in 0..frames.saturating_sub(1) {
        let ends: Vec<usize> =
            (0..count).filter(|t| movie.tracks[*t].end() == frame + 1 && next[*t].is_none()).collect();
        let soon = frame + 1..=(frame + LONGEST).min(frames - 1);
        let begins: Vec<usize> =
            (0..count).filter(|t| soon.contains(&movie.tracks[*t].first) && !taken[*t]).collect();
        for (end, begin) in assign(movie, frame, &ends, &begins) {
            next[end] = Some(begin);
            taken[begin] = true;
        }
    }
    let joins = taken.iter().filter(|taken| **taken).count();
    let mut tracks: Vec<Track> = Vec::with_capacity(count - joins);
    for head in (0..count).filter(|t| !taken[*t]) {
        let mut whole = Track { first: movie.tracks[head].first, seen: Vec::new(), names: Vec::new() };
        let mut part = Some(head);
        while let Some(own) = part {
            let piece = &movie.tracks[own];
            whole.seen.resize(piece.first - whole.first, None);
            let before = whole.seen.iter().rev().flatten().next().copied();
            // A part begins at whatever image of the box it was seen in.
            let image = match (before, piece.seen.iter().flatten().next()) {
                (Some(from), Some(to)) => movie.domain.shortest(to - from) - (to - from),
                _ => Vector::zeros(),
            };
            whole.seen.extend(piece.seen.iter().map(|place| place.map(|r| r + image)));
            whole.names.extend(&piece.names);
            part = next[own];
        }
        tracks.push(whole);
    }
    movie.tracks = tracks;
    joins
}

/// The ends in a frame and the later beginnings that are one cell.
fn assign(movie: &Movie, frame: usize, ends: &[usize], begins: &[usize]) -> Vec<(usize, usize)> {
    if ends.is_empty() || begins.is_empty() {
        return Vec::new();
    }
    let motion = Motion::new(movie, frame);
    let variance = motion.variance();
    let gain = |end: usize, begin: usize| -> f64 {
        let (track, later) = (&movie.tracks[end], &movie.tracks[begin]);
        let (Some(from), Some(to)) = (track.at(frame), later.at(later.first)) else { return 0.0 };
        let length = movie.times[later.first] - movie.times[frame];
        let share = length / (movie.times[frame + 1] - movie.times[frame]);
        let predicted = motion.around(from, None) * share;
        let miss = (movie.domain.shortest(to - from) - predicted).norm_squared();
        // Errors of the motion grow as those of a random walk.
        let variance = variance * share;
        -miss / (2.0 * variance) - (std::f64::consts::TAU * variance).ln()
    };
    let gains: Vec<Vec<i64>> = ends
        .iter()
        .map(|end| begins.iter().map(|begin| (gain(*end, *begin).max(0.0) * PARTS) as i64).collect())
        .collect();
    // The method wants no more rows than columns.
    let wide = ends.len() <= begins.len();
    let matrix = match wide {
        true => Matrix::from_fn(ends.len(), begins.len(), |(i, j)| gains[i][j]),
        false => Matrix::from_fn(begins.len(), ends.len(), |(j, i)| gains[i][j]),
    };
    let (_, partner) = kuhn_munkres(&matrix);
    let pairs =
        partner.into_iter().enumerate().map(|(row, column)| if wide { (row, column) } else { (column, row) });
    pairs.filter(|(i, j)| gains[*i][*j] > 0).map(|(i, j)| (ends[i], begins[j])).collect()
}

/// The motion of the cells that were seen in a frame and in the next.
struct Motion<'a> {
    movie: &'a Movie,
    /// Where each was, and how far it went.
    steps: Vec<(Vector<f64>, Vector<f64>)>,
}

impl<'a> Motion<'a> {
    fn new(movie: &'a Movie, frame: usize) -> Self {
        let steps = movie
            .increments(frame)
            .filter_map(|(track, step)| Some((movie.tracks[track].at(frame)?, step)))
            .collect();
        Self { movie, steps }
    }

    /// The mean motion of the nearest cells around a place, one of them left out.
    fn around(&self, place: Vector<f64>, without: Option<usize>) -> Vector<f64> {
        let mut nearest: Vec<(f64, usize)> = (0..self.steps.len())
            .filter(|k| Some(*k) != without)
            .map(|k| (self.movie.domain.shortest(self.steps[k].0 - place).norm_squared(), k))
            .collect();
        let count = NEIGHBOURS.min(nearest.len());
        if count == 0 {
            return Vector::zeros();
        }
        nearest.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let sum =
            nearest[..count].iter().fold(Vector::zeros(), |sum: Vector<f64>, (_, k)| sum + self.steps[*k].1);
        sum / count as f64
    }

    /// Variance of one component of the error of such a prediction, from the median of its square over the cells that go on: a
    /// squared distance in the plane has its median at 2 log 2 variances.
    fn variance(&self) -> f64 {
        let miss = |k: usize| (self.steps[k].1 - self.around(self.steps[k].0, Some(k))).norm_squared();
        let mut squares: Vec<f64> = (0..self.steps.len()).map(miss).collect();
        squares.sort_unstable_by(f64::total_cmp);
        let median = squares.get(squares.len() / 2).copied().unwrap_or(1.0);
        (median / (2.0 * std::f64::consts::LN_2)).max(SMALLEST_ERROR.powi(2))
    }
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
        assert_eq!((named(3).name(1), named(3).name(4)), (3, 36));
        assert_eq!((named(3).gaps(), named(8).gaps()), (0, 1));
        for (k, place) in named(3).seen.iter().enumerate() {
            let expected = whole.tracks[3].at(k).unwrap();
            assert!(domain.shortest(place.unwrap() - expected).norm() < 1e-12);
            // In one piece.
            assert!(k == 0 || (place.unwrap() - named(3).at(k - 1).unwrap()).norm() < 1.0);
        }
    }
}
