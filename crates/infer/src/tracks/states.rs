//! The unknowns of a movie: where its cells are at the frames and at instants between them.
//!
//! A cell has a place of its own at an instant if it was seen there or if its motion to or from there is explained. Elsewhere (at the
//! rim of an open field, between frames) it is on the straight line between its nearest places before and after, if there are both.

use super::movie::{Drift, Movie};
use super::rule::{Rule, Scheme};
use crate::{Error, Observation};
use rayon::prelude::*;
use voronudge_geometry::{Vector, Visibility};

/// One instant: the cells that are there.
#[derive(Debug, Clone)]
pub(crate) struct Instant {
    /// Time.
    pub time: f64,
    /// The frame, if it is one.
    pub frame: Option<usize>,
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

/// The middle of a step: the cells that are there at its beginning and its end.
#[derive(Debug, Clone)]
pub(crate) struct Middle {
    /// The cells half-way between where they begin.
    pub cells: Observation,
    /// Index of each cell at both instants.
    pub ends: Vec<[u32; 2]>,
    /// Whether the velocities at both ends say how the cell moves, which they do where its motion is explained.
    pub led: Vec<bool>,
}

/// One cell over the time between two frames.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    /// Frame at the beginning.
    pub interval: usize,
    /// Number of the track.
    pub track: u32,
    /// Index among the cells of each instant, from the first frame to the second.
    pub cells: Vec<u32>,
    /// Index among the cells in the middle of each step; empty for a rule without middles.
    pub middles: Vec<u32>,
    /// What finer steps add to the displacement.
    pub added: Vector<f64>,
}

/// The unknowns of a movie and the motions that are explained.
#[derive(Debug, Clone)]
pub(crate) struct States {
    pub rule: Rule,
    pub instants: Vec<Instant>,
    /// The middle of each step; none for a rule without.
    pub middles: Vec<Middle>,
    pub motions: Vec<Motion>,
    /// The measured places.
    pub anchors: Vec<u32>,
    /// Where each place is before any fit.
    pub start: Vec<Vector<f64>>,
    /// First of the translations, one for each interval, which stand behind the places; their number.
    pub drifts: (usize, usize),
}

/// Marks an absent cell.
const ABSENT: u32 = u32::MAX;

impl States {
    /// The unknowns for a rule of integration.
    ///
    /// # Errors
    /// [`Error::Geometry`].
    pub fn new(movie: &Movie, rule: Rule) -> Result<Self, Error> {
        let mut instants = instants(movie, rule)?;
        let steps = rule.steps;
        let mut middles = match rule.scheme {
            Scheme::Trapezoid => Vec::new(),
            Scheme::HermiteSimpson => middles(movie, &instants)?,
        };
        let found: Vec<Vec<Motion>> = (0..movie.frames() - 1)
            .into_par_iter()
            .map(|interval| {
                let of = |all: usize| interval * steps..(interval + 1) * steps + all;
                motions(movie, interval, &instants[of(1)], middles.get(of(0)).unwrap_or(&[]))
            })
            .collect();
        let motions: Vec<Motion> = found.into_iter().flatten().collect();
        for motion in &motions {
            for (step, cell) in motion.middles.iter().enumerate() {
                middles[motion.interval * steps + step].led[*cell as usize] = true;
            }
        }
        let mut own: Vec<Vec<bool>> =
            instants.iter().map(|instant| vec![false; instant.tracks.len()]).collect();
        for (instant, own) in instants.iter().zip(&mut own) {
            if let Some(frame) = instant.frame {
                for (track, own) in instant.tracks.iter().zip(own) {
                    *own = movie.tracks[*track as usize].at(frame).is_some();
                }
            }
        }
        for motion in &motions {
            for (node, cell) in motion.cells.iter().enumerate() {
                own[motion.interval * steps + node][*cell as usize] = true;
            }
        }
        // Places in the order of time for each cell: neighbours in time are neighbours in memory.
        let mut of_track: Vec<Vec<(usize, usize)>> = vec![Vec::new(); movie.tracks.len()];
        for (index, instant) in instants.iter().enumerate() {
            for (cell, track) in instant.tracks.iter().enumerate() {
                of_track[*track as usize].push((index, cell));
            }
        }
        let (mut start, mut anchors) = (Vec::new(), Vec::new());
        for all in &of_track {
            let mut waiting: Vec<(usize, usize)> = Vec::new();
            let mut before: Option<(u32, f64)> = None;
            for &(index, cell) in all {
                let instant = &mut instants[index];
                if !own[index][cell] {
                    waiting.push((index, cell));
                    continue;
                }
                let place = start.len() as u32;
                start.push(instant.cells.positions[cell]);
                if instant.frame.is_some() && instant.cells.is_seen(cell) {
                    anchors.push(place);
                }
                instant.place[cell] = Place::Own(place);
                let time = instant.time;
                for (index, cell) in waiting.drain(..) {
                    if let Some((earlier, begin)) = before {
                        let share = (instants[index].time - begin) / (time - begin);
                        instants[index].place[cell] = Place::Between(earlier, place, share);
                    }
                }
                before = Some((place, time));
            }
        }
        let drifts = match movie.drift {
            Drift::None => 0,
            Drift::PerInterval => movie.frames() - 1,
        };
        Ok(Self { rule, drifts: (start.len(), drifts), instants, middles, motions, anchors, start })
    }

    /// The same with positions measured at another share of the way to the centroids.
    pub fn at_share(mut self, share: f64) -> Self {
        for instant in self.instants.iter_mut().filter(|instant| instant.frame.is_some()) {
            instant.cells = instant.cells.clone().at_share(share);
        }
        self
    }

    /// The two unknowns of one block.
    pub fn vector(displacements: &[f64], block: usize) -> Vector<f64> {
        Vector::new(displacements[2 * block], displacements[2 * block + 1])
    }

    /// Place and time of each block before any fit; translations have none.
    pub fn where_and_when(&self) -> Vec<Option<[f64; 3]>> {
        let mut places = vec![None; self.blocks()];
        for instant in &self.instants {
            for place in &instant.place {
                if let Place::Own(own) = place {
                    let r = self.start[*own as usize];
                    places[*own as usize] = Some([r[0], r[1], instant.time]);
                }
            }
        }
        places
    }

    /// Where a cell is at an instant.
    pub fn position(&self, instant: usize, cell: usize, displacements: &[f64]) -> Vector<f64> {
        self.instants[instant].cells.positions[cell] + self.displacement(instant, cell, displacements)
    }

    /// How far a cell is at an instant from where it was before any fit.
    pub fn displacement(&self, instant: usize, cell: usize, displacements: &[f64]) -> Vector<f64> {
        let shares = self.instants[instant].place[cell].shares();
        shares.map(|(at, share)| Self::vector(displacements, at) * share).sum()
    }

    /// Number of places and translations: blocks of two unknowns.
    pub fn blocks(&self) -> usize {
        self.start.len() + self.drifts.1
    }

    /// The unknown of an interval's translation.
    pub fn drift(&self, interval: usize) -> Option<usize> {
        (interval < self.drifts.1).then_some(self.drifts.0 + interval)
    }
}

/// The instants with the cells that are there.
fn instants(movie: &Movie, rule: Rule) -> Result<Vec<Instant>, Error> {
    let last = movie.frames() - 1;
    let share = |step: usize| step as f64 / rule.steps as f64;
    let mut all: Vec<(usize, f64)> =
        (0..last).flat_map(|frame| (0..rule.steps).map(move |step| (frame, share(step)))).collect();
    all.push((last, 0.0));
    all.into_par_iter()
        .map(|(frame, share)| {
            let (mut tracks, mut positions, mut errors) = (Vec::new(), Vec::new(), Vec::new());
            for number in 0..movie.tracks.len() {
                let Some(here) = movie.near(number, frame) else { continue };
                let place = match share > 0.0 {
                    false => Some(here),
                    true => movie.near(number, frame + 1).map(|next| here + (next - here) * share),
                };
                if let Some(place) = place {
                    tracks.push(number as u32);
                    positions.push(place);
                    errors.push(movie.tracks[number].error(frame));
                }
            }
            let count = tracks.len();
            let mut cells = Observation::new(
                frame,
                positions,
                vec![None; count],
                movie.domain,
                movie.field_of_view.clone(),
            )?;
            if share == 0.0 {
                if errors.iter().any(|error| *error != 1.0) {
                    cells = cells.with_position_errors(&errors);
                }
                if movie.share() != 0.0 {
                    cells = cells.with_positions_at(movie.share())?;
                }
            }
            let span = if frame < last { movie.times[frame + 1] - movie.times[frame] } else { 0.0 };
            Ok(Instant {
                time: movie.times[frame] + share * span,
                frame: (share == 0.0).then_some(frame),
                tracks,
                cells,
                place: vec![Place::Fixed; count],
            })
        })
        .collect()
}

/// The middles between successive instants.
fn middles(movie: &Movie, instants: &[Instant]) -> Result<Vec<Middle>, Error> {
    let middle = |pair: &[Instant]| {
        let (mut ends, mut positions) = (Vec::new(), Vec::new());
        let after = indices(movie, &pair[1].tracks);
        for (cell, track) in pair[0].tracks.iter().enumerate() {
            let next = after[*track as usize];
            if next != ABSENT {
                ends.push([cell as u32, next]);
                positions
                    .push(0.5 * (pair[0].cells.positions[cell] + pair[1].cells.positions[next as usize]));
            }
        }
        let count = positions.len();
        let frame = pair[0].frame.unwrap_or(0);
        let cells =
            Observation::new(frame, positions, vec![None; count], movie.domain, movie.field_of_view.clone())?;
        Ok(Middle { cells, ends, led: vec![false; count] })
    };
    instants.par_windows(2).map(middle).collect()
}

/// Where each track stands in a list of some of them.
fn indices(movie: &Movie, tracks: &[u32]) -> Vec<u32> {
    let mut index = vec![ABSENT; movie.tracks.len()];
    (0..).zip(tracks).for_each(|(cell, track)| index[*track as usize] = cell);
    index
}

/// The motions over one interval that the model can explain: of cells whose surroundings are certain at all its instants and middles, and
/// are the same cells from beginning to end.
fn motions(movie: &Movie, interval: usize, instants: &[Instant], middles: &[Middle]) -> Vec<Motion> {
    let between: Vec<Vec<u32>> = middles
        .iter()
        .zip(instants)
        .map(|(middle, before)| middle.ends.iter().map(|ends| before.tracks[ends[0] as usize]).collect())
        .collect();
    let at_instants = instants.iter().map(|instant| (&instant.cells, &instant.tracks));
    let in_middles = middles.iter().zip(&between).map(|(middle, tracks)| (&middle.cells, tracks));
    let all: Vec<(&Observation, &Vec<u32>)> = at_instants.chain(in_middles).collect();
    let index: Vec<Vec<u32>> = all.iter().map(|(_, tracks)| indices(movie, tracks)).collect();
    let stays = |track: u32| index.iter().all(|own| own[track as usize] != ABSENT);
    // Cells whose polygon lacks a neighbour at some time.
    let mut doubtful = vec![false; movie.tracks.len()];
    for (cells, tracks) in &all {
        for (cell, track) in tracks.iter().enumerate() {
            let neighbours = cells.tessellation.neighbours(cell);
            doubtful[*track as usize] |=
                !(stays(*track) && neighbours.iter().all(|n| stays(tracks[*n as usize])));
        }
    }
    let explained = |track: &u32| {
        all.iter().zip(&index).all(|((cells, tracks), own)| {
            let cell = own[*track as usize];
            cell != ABSENT
                && cells.visibility[cell as usize] == Visibility::Counted
                && !doubtful[*track as usize]
                && cells
                    .tessellation
                    .neighbours(cell as usize)
                    .iter()
                    .all(|n| !doubtful[tracks[*n as usize] as usize])
        })
    };
    (0..movie.tracks.len() as u32)
        .filter(explained)
        .map(|track| {
            let mut cells: Vec<u32> = index.iter().map(|own| own[track as usize]).collect();
            let middles = cells.split_off(instants.len());
            Motion { interval, track, cells, middles, added: Vector::zeros() }
        })
        .collect()
}
