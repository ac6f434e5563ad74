//! A fitted movie laid out anew: with more frames between, or after, those that there are. Cells are where the fit has them, which changes no
//! information, and go on by the model without noise.

use super::movie::{Movie, Sighting, Track};
use super::objective::MovieObjective;
use super::passage::Passage;
use super::placed::{Instant, Placed};
use crate::Error;
use std::collections::BTreeMap;
use voronudge_geometry::Vector;

/// Place and velocity of each track of a frame.
type Moving = BTreeMap<u32, (Vector<f64>, Vector<f64>)>;

/// A fitted movie.
pub(super) struct Laid<'a> {
    objective: MovieObjective<'a>,
    frames: Vec<Moving>,
    drifts: Vec<Vector<f64>>,
    /// Velocities that cells of the last interval have besides those of the model.
    beside: Vec<Vector<f64>>,
    coefficients: Vec<f64>,
}

impl<'a> Laid<'a> {
    pub fn new(objective: MovieObjective<'a>, placed: &Placed<'_>, parameters: &[f64]) -> Self {
        let (free, displacements) = objective.split(parameters);
        let coefficients = objective.space.coefficients(free).as_slice().to_vec();
        let of_frame = |(frame, moving): (usize, &Instant<'_>)| {
            let tracks = objective.states.instants[frame].tracks.iter().copied();
            let positions = objective.positions(frame, displacements);
            tracks.zip(positions.into_iter().zip(moving.1.of_cells.iter().copied())).collect()
        };
        let last = objective.movie.frames() - 2;
        let ends = [last, last + 1].map(|frame| &placed.instants[frame].0.positions[..]);
        Self {
            frames: placed.instants.iter().enumerate().map(of_frame).collect(),
            drifts: (0..=last).map(|interval| objective.drift(interval, displacements)).collect(),
            beside: objective.beside(last, ends, displacements),
            objective,
            coefficients,
        }
    }

    /// Where a track is in a frame, with an error.
    fn sighting(&self, track: usize, frame: usize, error: f64) -> Option<Sighting> {
        let (position, _) = *self.frames[frame].get(&(track as u32))?;
        Some(Sighting { position, error })
    }

    /// The movie at other times, with what is seen of each track.
    fn movie(&self, times: Vec<f64>, drifts: impl Iterator<Item = Vector<f64>>, tracks: Vec<Track>) -> Movie {
        let mut stage = vec![Vector::zeros()];
        drifts.for_each(|drift| stage.push(stage[stage.len() - 1] + drift));
        Movie { times, tracks, stage, ..self.objective.movie.clone() }
    }

    /// With a frame half-way between each two. There cells are on the cubic that has the velocities of the model at both ends; who was seen
    /// at both is seen there too.
    pub fn halved(&self) -> Movie {
        let movie = self.objective.movie;
        let of_track = |(number, track): (usize, &Track)| {
            let mut seen = Vec::with_capacity(2 * track.seen.len());
            for frame in track.first..track.end() {
                seen.push(self.sighting(number, frame, track.error(frame)));
                if frame + 1 < track.end() {
                    let error = track.error(frame).max(track.error(frame + 1));
                    seen.push(self.between(number, frame).map(|position| Sighting { position, error }));
                }
            }
            let names = track.names.iter().map(|(from, name)| (2 * from, *name)).collect();
            Track { first: 2 * track.first, seen, names, label: track.label }
        };
        let tracks = movie.tracks.iter().enumerate().map(of_track).collect();
        let between = movie.times.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
        let times = between.chain(movie.times.last().copied()).collect();
        let drifts = self.drifts.iter().flat_map(|drift| [drift * 0.5; 2]);
        Movie { usual: 0.5 * movie.usual, ..self.movie(times, drifts, tracks) }
    }

    /// Where a track is half-way between a frame and the next.
    fn between(&self, track: usize, frame: usize) -> Option<Vector<f64>> {
        let [from, to] = [frame, frame + 1].map(|frame| self.frames[frame].get(&(track as u32)));
        let ((x, v), (y, w)) = (from?, to?);
        let bend = (v - w) * (0.125 * self.objective.span(frame));
        let is_known = bend.norm_squared().is_finite();
        Some((x + y) * 0.5 + if is_known { bend } else { Vector::zeros() })
    }

    /// With so many further frames at the last interval: cells that are there at its end go on by the model, those at the rim as they went.
    pub fn longer(&self, further: usize) -> Result<Movie, Error> {
        let movie = self.objective.movie;
        let last = movie.frames() - 2;
        let ends = &self.objective.states.intervals[last].ends;
        let [before, after] = [last, last + 1].map(|frame| &self.objective.states.instants[frame].tracks);
        let of_fit = |(number, track): (usize, &Track)| -> Track {
            let seen = (track.first..track.end())
                .map(|frame| self.sighting(number, frame, track.error(frame)))
                .collect();
            Track { seen, ..track.clone() }
        };
        let mut tracks: Vec<Track> = movie.tracks.iter().enumerate().map(of_fit).collect();
        let places = &self.frames[last + 1];
        let mut first = vec![Vector::zeros(); before.len()];
        for own in ends {
            first[own[0] as usize] = places[&after[own[1] as usize]].0;
        }
        let steps = self.objective.rule.steps();
        for _ in 0..further {
            let passage =
                Passage::new(self.objective, last, steps, &first, &self.beside, &self.coefficients)?;
            for (own, moved) in ends.iter().zip(&passage.moved) {
                let place = &mut first[own[0] as usize];
                *place += moved;
                let track = after[own[1] as usize] as usize;
                let error = movie.tracks[track].error(last + 1);
                tracks[track].seen.push(Some(Sighting { position: *place, error }));
            }
        }
        let (end, span) = (movie.times[last + 1], self.objective.span(last));
        let times = movie.times.iter().copied();
        let times = times.chain((1..=further).map(|k| end + span * k as f64)).collect();
        let drifts = self.drifts.iter().copied().chain(std::iter::repeat_n(self.drifts[last], further));
        Ok(self.movie(times, drifts, tracks))
    }
}
