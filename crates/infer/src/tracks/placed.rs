//! All frames of a movie at some places, how its cells get from one to the next, and what the model leaves of their motions.

use super::motions::Motion;
use super::objective::MovieObjective;
use super::passage::Passage;
use super::rule::Rule;
use crate::objective::{Evaluated, Nudged};
use crate::{Error, Observation};
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// The cells of a frame, with the velocities that the model gives them and their derivatives by the coefficients.
pub(crate) type Instant<'a> = (Nudged<'a>, Evaluated);

/// All frames at some places, and how the cells get from one to the next.
pub(crate) struct Placed<'a> {
    pub instants: Vec<Instant<'a>>,
    /// One for each interval; none for a rule without steps.
    pub passages: Vec<Passage<'a>>,
}

impl<'a> MovieObjective<'a> {
    /// The tessellations and velocities at all frames, and the motion between them.
    pub fn displaced(&self, parameters: &[f64]) -> Result<Placed<'a>, Error> {
        let (free, displacements) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let states = self.states;
        let moving = |frame: usize| {
            let positions = self.positions(frame, displacements);
            let cells = &states.instants[frame].cells;
            let tessellation =
                cells.moved_to(&positions).map_err(|source| Error::Geometry { frame, source })?;
            let nudged = Nudged::new(cells, self.structure, positions, tessellation);
            let evaluated = nudged.evaluate(coefficients.as_slice());
            Ok((nudged, evaluated))
        };
        // Of several faults the first is told, whatever thread comes upon it.
        let instants: Vec<Result<Instant<'_>, Error>> =
            (0..states.instants.len()).into_par_iter().map(moving).collect();
        let instants = instants.into_iter().collect::<Result<Vec<_>, _>>()?;
        let passage = |(interval, pair): (usize, &[Instant<'_>])| {
            let ends = [&pair[0].0.positions[..], &pair[1].0.positions[..]];
            let beside = self.beside(interval, ends, displacements);
            Passage::new(*self, interval, self.rule.steps(), ends[0], &beside, coefficients.as_slice())
        };
        let passages = match self.rule {
            Rule::Trapezoid => Vec::new(),
            Rule::RungeKutta(_) => {
                let all: Vec<Result<Passage<'_>, Error>> =
                    instants.par_windows(2).enumerate().map(passage).collect();
                all.into_iter().collect::<Result<Vec<_>, _>>()?
            }
        };
        Ok(Placed { instants, passages })
    }

    /// The velocity of each cell of an interval that is not the model's: of its polarity and of the stage, or of a straight way between both ends.
    pub(super) fn beside(
        &self,
        interval: usize,
        ends: [&[Vector<f64>]; 2],
        displacements: &[f64],
    ) -> Vec<Vector<f64>> {
        let between = &self.states.intervals[interval];
        let (span, drift) = (self.span(interval), self.drift(interval, displacements));
        let of_cell = |(number, own): (usize, &[u32; 2])| match between.led[number] {
            true => {
                let motion = Motion { interval, track: 0, cells: *own, between: number as u32 };
                drift / span + self.states.crawled(&motion, displacements) / self.movie.interval()
            }
            false => (ends[1][own[1] as usize] - ends[0][own[0] as usize]) / span,
        };
        between.ends.iter().enumerate().map(of_cell).collect()
    }

    /// The mean velocity of a motion, without the translation.
    pub fn mean_velocity(&self, placed: &Placed<'_>, motion: &Motion, displacements: &[f64]) -> Vector<f64> {
        match placed.passages.get(motion.interval) {
            Some(passage) => {
                let moved = passage.moved[motion.between as usize];
                (moved - self.drift(motion.interval, displacements)) / self.span(motion.interval)
            }
            None => {
                let at = |end: usize| {
                    placed.instants[motion.interval + end].1.of_cells[motion.cells[end] as usize]
                };
                (at(0) + at(1)) * 0.5 + self.states.crawled(motion, displacements) / self.movie.interval()
            }
        }
    }

    /// What the model leaves of each motion by itself, over √(T h).
    pub fn residuals(&self, placed: &Placed<'_>, parameters: &[f64]) -> Vec<Vector<f64>> {
        let (_, displacements) = self.split(parameters);
        let residual = |motion: &Motion| {
            let interval = motion.interval;
            let at = |end: usize| placed.instants[interval + end].0.positions[motion.cells[end] as usize];
            let moved = self.mean_velocity(placed, motion, displacements) * self.span(interval);
            (at(1) - at(0) - moved - self.drift(interval, displacements)) * self.unit(interval)
        };
        let motions = &self.states.motions;
        let mut rests: Vec<Vector<f64>> = motions.par_iter().map(residual).collect();
        if let Some(own) = self.states.own_motion.as_ref().filter(|_| !placed.passages.is_empty()) {
            let mut first = 0;
            for together in motions.chunk_by(|one, next| one.interval == next.interval) {
                own.of(together, &mut rests[first..first + together.len()]);
                first += together.len();
            }
        }
        rests
    }

    /// Something of each frame as it was measured, by how far its cells are from where they were before any fit (x and y of one after
    /// the other).
    pub fn of_seen<T: Send>(
        &self,
        placed: &Placed<'_>,
        displacements: &[f64],
        what: impl Fn(usize, &Observation, &Nudged<'_>, &[f64]) -> T + Sync,
    ) -> Vec<T> {
        let of_frame = |(frame, (nudged, _)): (usize, &Instant<'_>)| {
            let instant = &self.states.instants[frame];
            let cells = 0..instant.tracks.len();
            let nudges: Vec<f64> = cells
                .flat_map(|cell| <[f64; 2]>::from(self.states.displacement(frame, cell, displacements)))
                .collect();
            what(frame, &instant.cells, nudged, &nudges)
        };
        placed.instants.par_iter().enumerate().map(of_frame).collect()
    }
}
