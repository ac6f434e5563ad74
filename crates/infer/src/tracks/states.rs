//! The unknowns of a movie: where its cells are at the frames.
//!
//! A cell has a place of its own at a frame if it was seen there or if its motion to or from there is explained. Elsewhere (in gaps at the
//! rim of an open field) it is on the straight line between its nearest places before and after, if there are both.

use super::instants::{Instant, Interval, Place, instants, intervals};
use super::integrated::Integrated;
use super::motions::{Explained, Motion, explained, motions};
use super::movie::{Drift, Movie};
use super::own_motion::OwnMotion;
use super::polarities::{NONE, Polarities};
use crate::{Drives, Error};
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_linalg::Dissections;

/// The unknowns of a movie and the motions that are explained.
#[derive(Debug, Clone)]
pub(crate) struct States {
    pub instants: Vec<Instant>,
    pub intervals: Vec<Interval>,
    pub motions: Vec<Motion>,
    /// The measured places.
    pub anchors: Vec<u32>,
    /// Where each place is before any fit.
    pub start: Vec<Vector<f64>>,
    /// First of the translations, one for each interval, which stand behind the places; their number.
    pub drifts: (usize, usize),
    /// Polarities, where cells have them.
    pub polarities: Polarities,
    /// What tells the motions of cells that crawl apart from what their neighbours do to them.
    pub own_motion: Option<OwnMotion>,
    /// What the likelihood of the coefficients has beside the objective of cells that crawl.
    pub integrated: Option<Integrated>,
    /// Orders of elimination that are known.
    pub dissections: Dissections,
}

impl States {
    /// The unknowns of a fit.
    ///
    /// # Errors
    /// [`Error::Geometry`].
    pub fn new(movie: &Movie) -> Result<Self, Error> {
        Self::of(movie, Explained::Certain)
    }

    /// The unknowns.
    ///
    /// # Errors
    /// [`Error::Geometry`].
    pub fn of(movie: &Movie, which: Explained) -> Result<Self, Error> {
        let mut instants = instants(movie)?;
        let mut intervals = intervals(movie, &instants)?;
        let found: Vec<Vec<Motion>> = (0..intervals.len())
            .into_par_iter()
            .map(|interval| motions(movie, interval, (&instants, &intervals[interval]), which))
            .collect();
        let motions: Vec<Motion> = found.into_iter().flatten().collect();
        for motion in &motions {
            intervals[motion.interval].led[motion.between as usize] = true;
        }
        let mut own = explained(&instants, &motions);
        for (frame, (instant, own)) in instants.iter().zip(&mut own).enumerate() {
            for (track, own) in instant.tracks.iter().zip(own) {
                *own |= movie.tracks[*track as usize].at(frame).is_some();
            }
        }
        // Places in the order of time for each cell: neighbours in time are neighbours in memory.
        let mut of_track: Vec<Vec<(usize, usize)>> = vec![Vec::new(); movie.tracks.len()];
        for (frame, instant) in instants.iter().enumerate() {
            for (cell, track) in instant.tracks.iter().enumerate() {
                of_track[*track as usize].push((frame, cell));
            }
        }
        let (mut start, mut anchors) = (Vec::new(), Vec::new());
        for all in &of_track {
            let mut waiting: Vec<(usize, usize)> = Vec::new();
            let mut before: Option<(u32, f64)> = None;
            for &(frame, cell) in all {
                let instant = &mut instants[frame];
                if !own[frame][cell] {
                    waiting.push((frame, cell));
                    continue;
                }
                let place = start.len() as u32;
                start.push(instant.cells.positions[cell]);
                if instant.cells.is_seen(cell) {
                    anchors.push(place);
                }
                instant.place[cell] = Place::Own(place);
                let time = movie.times[frame];
                for (frame, cell) in waiting.drain(..) {
                    if let Some((earlier, begin)) = before {
                        let share = (movie.times[frame] - begin) / (time - begin);
                        instants[frame].place[cell] = Place::Between(earlier, place, share);
                    }
                }
                before = Some((place, time));
            }
        }
        let drifts = match movie.drift {
            Drift::None => 0,
            Drift::PerInterval => movie.frames() - 1,
        };
        let drifts = (start.len(), drifts);
        let polarities = Polarities::default();
        Ok(Self {
            drifts,
            instants,
            intervals,
            motions,
            anchors,
            start,
            polarities,
            own_motion: None,
            integrated: None,
            dissections: Dissections::default(),
        })
    }

    /// The same with positions measured at another share of the way to the centroids.
    pub fn at_share(mut self, share: f64) -> Self {
        for instant in &mut self.instants {
            instant.cells = instant.cells.clone().at_share(share);
        }
        self
    }

    /// The same with a polarity of each cell, for a model of so many terms.
    pub fn crawling(self, movie: &Movie, terms: usize) -> Self {
        let polarities = Polarities::new(movie, &self.instants, &self.motions, self.blocks(), terms);
        Self { polarities, ..self }
    }

    /// The same with polarities that may align with those of the neighbours.
    pub fn aligning(self) -> Self {
        Self { polarities: self.polarities.aligning(&self.instants), ..self }
    }

    /// The same with polarities that may be driven.
    pub fn driven_by(self, drives: Drives) -> Self {
        let polarities = if drives.any() { self.polarities.driven_by(drives) } else { self.polarities };
        Self { polarities, ..self }
    }

    /// The same with polarities each by itself.
    pub fn apart(mut self) -> Self {
        self.polarities = self.polarities.apart();
        self
    }

    /// The polarity of a cell at both ends of its motion.
    pub fn polarity(&self, motion: &Motion) -> Option<[usize; 2]> {
        let block = |end: usize| {
            let of_frame = self.polarities.block.get(motion.interval + end)?;
            of_frame
                .get(motion.cells[end] as usize)
                .filter(|block| **block != NONE)
                .map(|block| *block as usize)
        };
        Some([block(0)?, block(1)?])
    }

    /// How far a cell crawls in a usual interval, by its polarity at both ends of its motion.
    pub fn crawled(&self, motion: &Motion, displacements: &[f64]) -> Vector<f64> {
        let mean = |ends: [usize; 2]| {
            ends.iter().map(|block| Self::vector(displacements, *block)).sum::<Vector<f64>>() * 0.5
        };
        self.polarity(motion).map_or(Vector::zeros(), mean)
    }

    /// The cells of the interval of a motion whose ways count for where it ends, if motions are told apart.
    pub fn pushing(&self, motion: &Motion) -> &[u32] {
        let own = self.own_motion.as_ref();
        own.map_or(&[], |own| own.pushing(motion.interval, motion.between as usize))
    }

    /// The two unknowns of one block.
    pub fn vector(displacements: &[f64], block: usize) -> Vector<f64> {
        Vector::new(displacements[2 * block], displacements[2 * block + 1])
    }

    /// Place and time of each block before any fit; translations have none.
    pub fn where_and_when(&self, times: &[f64]) -> Vec<Option<[f64; 3]>> {
        let mut places = vec![None; self.blocks()];
        for (instant, time) in self.instants.iter().zip(times) {
            for place in &instant.place {
                if let Place::Own(own) = place {
                    let r = self.start[*own as usize];
                    places[*own as usize] = Some([r[0], r[1], *time]);
                }
            }
        }
        for ((of_frame, instant), time) in self.polarities.block.iter().zip(&self.instants).zip(times) {
            for (block, r) in
                of_frame.iter().zip(&instant.cells.positions).filter(|(block, _)| **block != NONE)
            {
                places[*block as usize] = Some([r[0], r[1], *time]);
            }
        }
        places
    }

    /// Which blocks belong to the same cell, by a number of each; translations and what drives polarities are by themselves.
    pub fn chains(&self) -> Vec<u32> {
        let blocks = self.blocks() as u32;
        let mut chains: Vec<u32> = (0..blocks).map(|block| u32::MAX - block).collect();
        for (frame, instant) in self.instants.iter().enumerate() {
            let polarities = self.polarities.block.get(frame);
            for (cell, track) in instant.tracks.iter().enumerate() {
                if let Place::Own(own) = instant.place[cell] {
                    chains[own as usize] = *track;
                }
                if let Some(own) = polarities.map(|of_frame| of_frame[cell]).filter(|block| *block != NONE) {
                    chains[own as usize] = *track;
                }
            }
        }
        chains
    }

    /// Which cells of each frame have a motion to or from there that is explained.
    pub fn explained(&self) -> Vec<Vec<bool>> {
        explained(&self.instants, &self.motions)
    }

    /// Where a cell is at a frame.
    pub fn position(&self, instant: usize, cell: usize, displacements: &[f64]) -> Vector<f64> {
        self.instants[instant].cells.positions[cell] + self.displacement(instant, cell, displacements)
    }

    /// How far a cell is at a frame from where it was before any fit.
    pub fn displacement(&self, instant: usize, cell: usize, displacements: &[f64]) -> Vector<f64> {
        let shares = self.instants[instant].place[cell].shares();
        shares.map(|(at, share)| Self::vector(displacements, at) * share).sum()
    }

    /// Number of places, translations and polarities: blocks of two unknowns.
    pub fn blocks(&self) -> usize {
        self.start.len() + self.drifts.1 + self.polarities.blocks()
    }

    /// Number of blocks of places, translations and polarities.
    pub fn unknowns_of_cells(&self) -> usize {
        self.polarities_begin() + self.polarities.count()
    }

    /// Number of places and translations, which stand before all polarities.
    pub fn polarities_begin(&self) -> usize {
        self.start.len() + self.drifts.1
    }

    /// The unknown of an interval's translation.
    pub fn drift(&self, interval: usize) -> Option<usize> {
        (interval < self.drifts.1).then_some(self.drifts.0 + interval)
    }
}
