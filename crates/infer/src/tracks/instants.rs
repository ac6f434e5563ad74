//! The cells of a movie at its frames and between them, before any fit.

use super::movie::Movie;
use crate::{Error, Observation};
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// Marks an absent cell.
pub(super) const ABSENT: u32 = u32::MAX;

/// The cells that are there at a frame.
#[derive(Debug, Clone)]
pub(crate) struct Instant {
    /// Number of the track of each cell.
    pub tracks: Vec<u32>,
    /// The cells where they were seen, or on the line between.
    pub cells: Observation,
    /// On which places the position of each cell depends, with their shares.
    pub place: Vec<Place>,
}

/// On which places a position depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// Its own.
    Own(u32),
    /// On the line between two: the share of the second.
    Between(u32, u32, f64),
    /// None: the cell stays where it is thought to be.
    Fixed,
}

impl Place {
    /// The places and their shares.
    pub fn shares(self) -> impl Iterator<Item = (usize, f64)> {
        let (first, second) = match self {
            Self::Own(place) => (Some((place, 1.0)), None),
            Self::Between(before, after, share) => (Some((before, 1.0 - share)), Some((after, share))),
            Self::Fixed => (None, None),
        };
        first.into_iter().chain(second).map(|(place, share)| (place as usize, share))
    }
}

/// The time between two frames: the cells that are there at both.
#[derive(Debug, Clone)]
pub(crate) struct Interval {
    /// The cells half-way between where they begin.
    pub halfway: Observation,
    /// Index of each cell at both frames.
    pub ends: Vec<[u32; 2]>,
    /// Whether the model says how the cell moves, which it does where its motion is explained. The others go straight.
    pub led: Vec<bool>,
}

/// The frames with the cells that are there.
pub(super) fn instants(movie: &Movie) -> Result<Vec<Instant>, Error> {
    let instant = |frame: usize| {
        let (mut tracks, mut positions, mut errors) = (Vec::new(), Vec::new(), Vec::new());
        for number in 0..movie.tracks.len() {
            if let Some(place) = movie.near(number, frame) {
                tracks.push(number as u32);
                positions.push(place);
                errors.push(movie.tracks[number].error(frame));
            }
        }
        let mut cells = still(movie, frame, positions, &tracks)?;
        if errors.iter().any(|error| *error != 1.0) {
            cells = cells.with_position_errors(&errors);
        }
        let cells = cells.with_positions_at(movie.share())?;
        let place = vec![Place::Fixed; tracks.len()];
        Ok(Instant { tracks, cells, place })
    };
    (0..movie.frames()).into_par_iter().map(instant).collect()
}

/// Cells of a movie without velocities.
fn still(
    movie: &Movie,
    frame: usize,
    positions: Vec<Vector<f64>>,
    tracks: &[u32],
) -> Result<Observation, Error> {
    let velocities = vec![None; positions.len()];
    let cells = Observation::new(frame, positions, velocities, movie.domain, movie.field_of_view.clone())?;
    Ok(cells.within(movie.environment_of(tracks)))
}

/// The times between frames.
pub(super) fn intervals(movie: &Movie, instants: &[Instant]) -> Result<Vec<Interval>, Error> {
    let interval = |(frame, pair): (usize, &[Instant])| {
        let (mut ends, mut positions, mut tracks) = (Vec::new(), Vec::new(), Vec::new());
        let after = indices(movie, pair[1].tracks.iter().copied());
        for (cell, track) in pair[0].tracks.iter().enumerate() {
            let next = after[*track as usize];
            if next != ABSENT {
                ends.push([cell as u32, next]);
                tracks.push(*track);
                positions
                    .push(0.5 * (pair[0].cells.positions[cell] + pair[1].cells.positions[next as usize]));
            }
        }
        let led = vec![false; ends.len()];
        Ok(Interval { halfway: still(movie, frame, positions, &tracks)?, ends, led })
    };
    instants.par_windows(2).enumerate().map(interval).collect()
}

/// Where each track stands in a list of some of them.
pub(super) fn indices(movie: &Movie, tracks: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut index = vec![ABSENT; movie.tracks.len()];
    (0..).zip(tracks).for_each(|(cell, track)| index[track as usize] = cell);
    index
}
