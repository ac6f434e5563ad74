//! The cells at the beginning of a forecast, and what is seen of them before and after.

use super::Said;
use crate::seeds::{Purpose, seed_of};
use crate::tracks::Present;
use crate::{Error, Movie, Observation};
use std::sync::Arc;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::Environment;

/// Where cells are when a forecast begins.
pub(super) struct Start<'a> {
    pub movie: &'a Movie,
    pub frame: usize,
    /// Track of each cell.
    pub tracks: Vec<usize>,
    pub cells: Observation,
    /// Cells whose velocities the model can tell: those with all their neighbours in view.
    pub in_view: Vec<bool>,
    /// Displacement in the interval before, where the cell was seen at both ends.
    pub before: Vec<Option<Vector<f64>>>,
}

/// Where the cells are, and their polarities where anything is known of them.
pub(super) struct Begun {
    pub positions: Vec<Vector<f64>>,
    pub polarities: Vec<Option<Vector<f64>>>,
}

/// The mean over those neighbours of a cell of which something is known.
pub(super) fn of_neighbours(
    tessellation: &Tessellation,
    cell: usize,
    known: &[Option<Vector<f64>>],
) -> Option<Vector<f64>> {
    let all = tessellation.neighbours(cell).iter().filter_map(|other| known[*other as usize]);
    let (sum, count) = all.fold((Vector::zeros(), 0.0), |(sum, count), own| (sum + own, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

impl<'a> Start<'a> {
    pub fn new(movie: &'a Movie, frame: usize) -> Result<Self, Error> {
        let (tracks, positions): (Vec<usize>, Vec<Vector<f64>>) =
            movie.present(frame).filter_map(|track| Some((track, movie.last_place(track, frame)?))).unzip();
        let none = vec![Some(Vector::zeros()); positions.len()];
        let cells = Observation::new(frame, positions, none, movie.domain, movie.field_of_view.clone())?;
        let cells = cells.within(movie.environment());
        let in_view = (0..tracks.len()).map(|cell| cells.target(cell).is_some()).collect();
        let mut start = Self { movie, frame, tracks, cells, in_view, before: Vec::new() };
        start.before = (0..start.tracks.len())
            .map(|cell| start.displacement(cell, frame.checked_sub(1)?, frame))
            .collect();
        Ok(start)
    }

    /// How far a cell went from one frame to another beside the stage, where it was seen at both.
    pub fn displacement(&self, cell: usize, from: usize, to: usize) -> Option<Vector<f64>> {
        let track = &self.movie.tracks[self.tracks[cell]];
        Some(track.at(to)? - track.at(from)? - self.movie.drifted(from, to))
    }

    /// What surrounds the cells, and how they moved before.
    pub fn history(&self, earlier: Vec<Option<Vector<f64>>>) -> Arc<Environment> {
        let around = self.cells.environment();
        Environment::clone(around).with_earlier(earlier).map_or_else(|_| around.clone(), Arc::new)
    }

    /// The cells where they were seen.
    pub fn as_measured(&self) -> Begun {
        Begun { positions: self.cells.positions.clone(), polarities: vec![None; self.tracks.len()] }
    }

    /// The cells where they are thought to be.
    pub fn begun(&self, present: &[Present]) -> Begun {
        let mut begun = self.as_measured();
        for Present { track, position, polarity } in present {
            if let Ok(cell) = self.tracks.binary_search(track) {
                begun.positions[cell] = *position;
                begun.polarities[cell] = *polarity;
            }
        }
        begun
    }

    /// The time from one frame to another.
    pub fn time(&self, from: usize, to: usize) -> f64 {
        self.movie.times[to] - self.movie.times[from]
    }

    /// The time between frames that come, the first and so on; the last one known goes on.
    pub fn interval(&self, ahead: usize) -> f64 {
        let from = (self.frame + ahead).min(self.movie.frames() - 2);
        self.time(from, from + 1)
    }

    /// Mean velocity of the neighbours in the interval before.
    pub fn before_around(&self, cell: usize) -> Option<Vector<f64>> {
        let moved = of_neighbours(&self.cells.tessellation, cell, &self.before)?;
        Some(moved / self.time(self.frame - 1, self.frame))
    }

    /// Velocity in the interval before.
    pub fn velocity_before(&self, cell: usize) -> Option<Vector<f64>> {
        Some(self.before[cell]? / self.time(self.frame - 1, self.frame))
    }

    /// A seed of its own for each draw.
    pub fn seed(&self, seed: u64, draw: u64) -> u64 {
        seed_of(seed, Purpose::After(self.frame), draw)
    }

    /// Time from the start to each horizon.
    pub fn times(&self, horizon: usize) -> impl Iterator<Item = f64> + '_ {
        (0..horizon).scan(0.0, |time, ahead| {
            *time += self.interval(ahead);
            Some(*time)
        })
    }

    /// Each cell stays where it is.
    pub fn no_motion(&self, horizon: usize) -> Said {
        (vec![vec![Vector::zeros(); self.tracks.len()]; horizon], None)
    }

    /// Each cell keeps its velocity.
    pub fn constant_velocity(&self, horizon: usize) -> Said {
        let at = |time: f64| {
            let of = |cell: usize| self.velocity_before(cell).unwrap_or_else(Vector::zeros) * time;
            (0..self.tracks.len()).map(of).collect()
        };
        (self.times(horizon).map(at).collect(), None)
    }

    /// The cells whose forecast is scored: in view, and seen now and before.
    pub fn scored(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.tracks.len()).filter(|cell| self.in_view[*cell] && self.before[*cell].is_some())
    }
}
