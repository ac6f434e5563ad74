//! How the neighbours of a place move, which predicts how a cell there does.

use super::movie::Movie;
use voronudge_geometry::Vector;

/// Neighbours whose motion predicts that of a cell.
const NEIGHBOURS: usize = 6;

/// Smallest error of a prediction, in units of ℓ₀.
const SMALLEST_ERROR: f64 = 1e-3;

/// The motion of the cells that were seen in a frame and in the next.
pub(super) struct Motion<'a> {
    movie: &'a Movie,
    /// Where each was, and how far it went.
    steps: Vec<(Vector<f64>, Vector<f64>)>,
    /// Their tracks, ascending.
    tracks: Vec<usize>,
    /// Squared scale of the errors of predictions.
    pub square: f64,
    /// Tracks that begin in the next frame, to a cell that goes on: to a unit area, about.
    pub beginnings: f64,
}

/// Log density of a cell at a distance from where it should be, given its square: Student's with two degrees of freedom in the plane.
pub(super) fn log_density(distance_squared: f64, square: f64) -> f64 {
    -2.0 * (distance_squared / (2.0 * square)).ln_1p() - (std::f64::consts::TAU * square).ln()
}

impl<'a> Motion<'a> {
    pub fn new(movie: &'a Movie, frame: usize) -> Self {
        let step =
            |(track, step): (usize, Vector<f64>)| Some((track, (movie.tracks[track].at(frame)?, step)));
        let (tracks, steps): (Vec<usize>, Vec<_>) = movie.increments(frame).filter_map(step).unzip();
        let begin = movie.tracks.iter().filter(|track| track.first == frame + 1).count();
        let beginnings = begin.max(1) as f64 / steps.len().max(1) as f64;
        let motion = Self { movie, steps, tracks, square: 1.0, beginnings };
        Self { square: motion.learn_square(), ..motion }
    }

    /// Number of the step of a track, if it was seen in both frames.
    pub fn step_of(&self, track: usize) -> Option<usize> {
        self.tracks.binary_search(&track).ok()
    }

    /// The mean motion of the nearest cells around a place, one of them left out.
    pub fn around(&self, place: Vector<f64>, without: Option<usize>) -> Vector<f64> {
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

    /// s² of such a prediction, from the median of its square over the cells that go on, which for t₂ in the plane is 2 s².
    fn learn_square(&self) -> f64 {
        let miss = |k: usize| (self.steps[k].1 - self.around(self.steps[k].0, Some(k))).norm_squared();
        let mut squares: Vec<f64> = (0..self.steps.len()).map(miss).collect();
        squares.sort_unstable_by(f64::total_cmp);
        let median = squares.get(squares.len() / 2).copied().unwrap_or(1.0);
        (median / 2.0).max(SMALLEST_ERROR.powi(2))
    }
}
