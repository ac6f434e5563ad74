//! Space-time nudging: the objective of a movie.
//!
//! ```text
//! Φ(β, x) = Σ ‖x_{f+1} − x_f − ∫F_β − d_f‖² / (T h_f)  +  k Σ_anchors m ‖y − H(x)‖²,      k = σ_v² / σ_r²
//! ```
//!
//! with, in place of the square of what is left of a motion, the loss of a contaminated normal distribution (see [`crate::robust`]),
//! with places x of the cells at all frames, h_f the time between two of them, T the usual one, and d the
//! translation of the stage. What the model misses of a displacement is a random walk: its variance grows
//! with the time, so that σ_v is the error of a mean velocity over T.

use super::anchors::Share;
use super::memory::Memory;
use super::motions::Motion;
use super::movie::Movie;
use super::passage::Passage;
use super::rule::Rule;
use super::states::States;
use crate::normal_equations::NormalEquations;
use crate::objective::{Evaluated, Nudged};
use crate::placing::Placing;
use crate::position_rows::squares;
use crate::robust::{loss, posterior_weight};
use crate::{CoefficientSpace, Error, NoiseLevels, Observation};
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Standard deviation of what nothing holds about where it began, in units of ℓ₀: none to speak of.
const FAR: f64 = 30.0;

/// Standard deviation of the place of a cell that was not seen about the middle of the room that the others leave it, in units of ℓ₀. Without it such
/// cells of measured tissues moved onto their neighbours.
const ROOM: f64 = 0.3;

/// Share of motions that nothing explains. Where contacts change, the way of a cell forks, and a fit can be caught on the wrong side of a
/// fork: what is then left of its motion must not decide a coefficient, nor keep it from crossing over.
const UNEXPLAINED: f64 = 0.01;

/// The penalised objective of a movie. The parameter vector is β, then the displacements from where places began, x and y of one place
/// after the other, then the translations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovieObjective<'a> {
    pub movie: &'a Movie,
    pub states: &'a States,
    pub rule: Rule,
    pub structure: &'a Structure,
    pub space: &'a CoefficientSpace,
    pub levels: NoiseLevels,
    /// How what the model leaves of the motion of a cell goes on from one interval to the next, if it does.
    pub memory: Option<Memory>,
}

/// The cells of a frame, with the velocities that the model gives them and their derivatives by the coefficients.
pub(crate) type Instant<'a> = (Nudged<'a>, Evaluated);

/// All frames at some places, and how the cells get from one to the next.
pub(crate) struct Placed<'a> {
    pub instants: Vec<Instant<'a>>,
    /// One for each interval; none for a rule without steps.
    pub passages: Vec<Passage<'a>>,
}

/// The parts of Φ, without their factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MovieParts {
    /// What counts of the squared residuals of motions.
    pub residual: f64,
    /// Sum of the squares of what is left of the measured positions, each over the square of its error in units of σ_r.
    pub nudges: f64,
    /// What keeps places that were not seen, and polarities.
    pub floor: f64,
    /// Penalty of the priors.
    pub priors: f64,
}

impl<'a> MovieObjective<'a> {
    /// β and the displacements.
    pub fn split<'p>(&self, parameters: &'p [f64]) -> (&'p [f64], &'p [f64]) {
        parameters.split_at(self.space.dimension())
    }

    /// The point where nothing is displaced, with some β.
    pub fn start(&self, free: &[f64]) -> Vec<f64> {
        let mut at = free.to_vec();
        at.resize(free.len() + 2 * self.states.blocks(), 0.0);
        at
    }

    /// Number of measured components that no unknown without a measurement takes up.
    pub fn components(&self) -> usize {
        let rows = 2 * self.states.motions.len();
        let held = self.states.anchors.len() + self.states.polarities.count();
        rows.saturating_sub(2 * (self.states.blocks() - held))
    }

    /// The same without the components of motions that nothing explains.
    pub fn explained_components(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        let missing: f64 = self.weights(placed, parameters).iter().map(|weight| 2.0 * (1.0 - weight)).sum();
        (self.components() as f64 - missing).max(1.0)
    }

    /// What Φ is expected to be if model and noise levels are right.
    pub fn expected(&self) -> f64 {
        let left = self.components() + self.space.priors().len();
        self.levels.velocity.powi(2) * left.saturating_sub(self.space.dimension()).max(1) as f64
    }

    /// Positions of the cells at a frame.
    pub fn positions(&self, index: usize, displacements: &[f64]) -> Vec<Vector<f64>> {
        let cells = self.states.instants[index].tracks.len();
        (0..cells).map(|cell| self.states.position(index, cell, displacements)).collect()
    }

    /// The translation of an interval.
    pub fn drift(&self, interval: usize, displacements: &[f64]) -> Vector<f64> {
        let first = self.movie.first_drift(interval);
        self.states.drift(interval).map_or(first, |at| first + States::vector(displacements, at))
    }

    /// The time of an interval.
    pub fn span(&self, interval: usize) -> f64 {
        self.movie.times[interval + 1] - self.movie.times[interval]
    }

    /// One over √(T h) for an interval.
    pub fn unit(&self, interval: usize) -> f64 {
        1.0 / (self.movie.interval() * self.span(interval)).sqrt()
    }

    /// The directions of the free coefficients in those of the model.
    pub fn along(&self) -> Vec<Vec<f64>> {
        self.space.basis().column_iter().map(|column| column.iter().copied().collect()).collect()
    }

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

    /// What counts of what the model leaves of a motion.
    pub fn counted(&self, rest: &Vector<f64>) -> f64 {
        let variance = self.levels.velocity.powi(2);
        variance * loss(rest.norm_squared() / variance, UNEXPLAINED)
    }

    /// How much each motion counts, by what the model leaves of it.
    pub fn weights(&self, placed: &Placed<'_>, parameters: &[f64]) -> Vec<f64> {
        let variance = self.levels.velocity.powi(2);
        let weight = |rest: &Vector<f64>| posterior_weight(rest.norm_squared() / variance, UNEXPLAINED);
        self.residuals(placed, parameters).iter().map(weight).collect()
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

    /// Stiffness of what nothing holds.
    pub fn floor(&self) -> f64 {
        (self.levels.velocity / FAR).powi(2)
    }

    /// Stiffness of places that were not seen.
    pub fn stiffness_of_room(&self) -> f64 {
        (self.levels.velocity / ROOM).powi(2)
    }

    /// The parts of Φ.
    pub fn parts(&self, parameters: &[f64]) -> Result<MovieParts, Error> {
        Ok(self.parts_of(&self.displaced(parameters)?, parameters))
    }

    fn parts_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> MovieParts {
        let (free, displacements) = self.split(parameters);
        let rests = self.residuals(placed, parameters);
        let residual = rests.iter().map(|rest| self.counted(rest)).sum();
        let of_seen = self.of_seen(placed, displacements, |_, cells, nudged, nudges| {
            squares(cells, &nudged.tessellation, &nudged.positions, nudges).sum::<f64>()
        });
        let nudges = of_seen.iter().sum();
        let surprise = self.weight_of_outset() * self.surprise(placed, displacements);
        let floor = self.stiffness().of(displacements) + surprise + self.driven(placed, parameters);
        let priors = self.space.penalty(&self.space.coefficients(free), self.levels.velocity);
        MovieParts { residual, nudges, floor, priors }
    }

    /// Φ with what integrating over the unknowns adds; infinite where there is no tessellation.
    pub fn value(&self, parameters: &[f64]) -> f64 {
        self.phi(parameters) + self.integration(self.split(parameters).0)
    }

    /// Φ by itself; infinite where there is no tessellation.
    pub fn phi(&self, parameters: &[f64]) -> f64 {
        self.displaced(parameters).map_or(f64::INFINITY, |placed| self.phi_of(&placed, parameters))
    }

    /// The same where cells are placed already.
    pub(super) fn phi_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        let parts = self.parts_of(placed, parameters);
        let value = parts.residual + self.levels.spring() * parts.nudges + parts.floor + parts.priors;
        if value.is_nan() { f64::INFINITY } else { value }
    }
}

impl<'a> Placing for MovieObjective<'a> {
    type Placed = Placed<'a>;

    fn placed_at(&self, parameters: &[f64]) -> Result<Placed<'a>, Error> {
        self.displaced(parameters)
    }

    fn value_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> f64 {
        self.phi_of(placed, parameters) + self.integration(self.split(parameters).0)
    }

    fn linearise_of(&self, placed: &Placed<'_>, parameters: &[f64]) -> Result<NormalEquations, Error> {
        let equations = self.linearise_at(placed, parameters, Share::Known)?;
        Ok(equations.tilted(self.tilt(self.split(parameters).0)))
    }

    fn obstacles_between(
        &self,
        before: (&Placed<'_>, &[f64]),
        after: (&Placed<'_>, &[f64]),
        promised: f64,
    ) -> Option<Vec<usize>> {
        self.obstacles(before, after, promised)
    }
}
