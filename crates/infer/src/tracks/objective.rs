//! Space-time nudging: the objective of a movie.
//!
//! ```text
//! Φ(β, x) = Σ ‖x_{j+1} − x_j − ∫F_β − d‖² / (T h_j)  +  k Σ_anchors m ‖y − H(x)‖²,      k = σ_v² / σ_r²
//! ```
//!
//! with places x of the cells at all instants, h_j the time between two of them, T the usual time between two frames, and d the
//! translation of the stage, shared out over the interval. What the model misses of a displacement is a random walk: its variance grows
//! with the time, so that σ_v is the error of a mean velocity over T, whatever the number of instants.

use super::movie::Movie;
use super::states::{Motion, States};
use crate::normal_equations::NormalEquations;
use crate::objective::{Evaluated, Nudged};
use crate::position_rows::squares;
use crate::{CoefficientSpace, Error, NoiseLevels, Observation};
use argmin::core::{CostFunction, Error as ArgminError, Jacobian};
use rayon::prelude::*;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::Structure;

/// Standard deviation of a place that nothing holds about where it began, in units of ℓ₀: none to speak of.
const FAR: f64 = 30.0;

/// The penalised objective of a movie. The parameter vector is β, then the displacements from where places began, x and y of one place
/// after the other, then the translations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovieObjective<'a> {
    pub movie: &'a Movie,
    pub states: &'a States,
    pub structure: &'a Structure,
    pub space: &'a CoefficientSpace,
    pub levels: NoiseLevels,
}

/// Cells at some time, with the velocities that the model gives them.
pub(crate) type Moving<'a> = (Nudged<'a>, Evaluated);

/// All instants at some places, and the middles between them.
pub(crate) struct Placed<'a> {
    pub instants: Vec<Moving<'a>>,
    pub middles: Vec<Moving<'a>>,
}

/// The parts of Φ, without their factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MovieParts {
    /// Sum of the squared residuals of motions.
    pub residual: f64,
    /// Sum of the squares of what is left of the measured positions, each over the square of its error in units of σ_r.
    pub nudges: f64,
    /// What keeps places that were not seen.
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
        let rows = 2 * self.states.motions.len() * self.states.rule.steps;
        rows.saturating_sub(2 * (self.states.blocks() - self.states.anchors.len()))
    }

    /// What Φ is expected to be if model and noise levels are right.
    pub fn expected(&self) -> f64 {
        let left = self.components() + self.space.priors().len();
        self.levels.velocity.powi(2) * left.saturating_sub(self.space.dimension()).max(1) as f64
    }

    /// Positions of the cells at an instant.
    pub fn positions(&self, index: usize, displacements: &[f64]) -> Vec<Vector<f64>> {
        let cells = self.states.instants[index].tracks.len();
        (0..cells).map(|cell| self.states.position(index, cell, displacements)).collect()
    }

    /// The translation of an interval.
    pub fn drift(&self, interval: usize, displacements: &[f64]) -> Vector<f64> {
        let first = self.movie.first_drift(interval);
        self.states.drift(interval).map_or(first, |at| first + States::vector(displacements, at))
    }

    /// The time of each step of an interval.
    pub fn length(&self, interval: usize) -> f64 {
        let span = self.movie.times[interval + 1] - self.movie.times[interval];
        span / self.states.rule.steps as f64
    }

    /// One over √(T h) for the steps of an interval.
    pub fn unit(&self, interval: usize) -> f64 {
        1.0 / (self.movie.interval() * self.length(interval)).sqrt()
    }

    /// The tessellations and velocities at all instants and middles.
    pub fn place(&self, parameters: &[f64]) -> Result<Placed<'a>, Error> {
        let (free, displacements) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let states = self.states;
        let moving = |index: usize, cells: &Observation, positions: Vec<Vector<f64>>| {
            let frame = index / states.rule.steps;
            let tessellation = Tessellation::new(&positions, self.movie.domain)
                .map_err(|source| Error::Geometry { frame, source })?;
            let nudged = Nudged::new(cells, self.structure, positions, tessellation);
            let evaluated = nudged.evaluate(coefficients.as_slice());
            Ok((nudged, evaluated))
        };
        let instants = (0..states.instants.len())
            .into_par_iter()
            .map(|index| moving(index, &states.instants[index].cells, self.positions(index, displacements)))
            .collect::<Result<Vec<Moving<'_>>, Error>>()?;
        let middles = (0..states.middles.len())
            .into_par_iter()
            .map(|index| {
                let positions = self.middle(index, &instants[index], &instants[index + 1]);
                moving(index, &states.middles[index].cells, positions)
            })
            .collect::<Result<Vec<Moving<'_>>, Error>>()?;
        Ok(Placed { instants, middles })
    }

    /// Positions in the middle of a step between two instants.
    fn middle(&self, index: usize, begin: &Moving<'_>, end: &Moving<'_>) -> Vec<Vector<f64>> {
        let middle = &self.states.middles[index];
        let eighth = self.length(index / self.states.rule.steps) / 8.0;
        let place = |(ends, led): (&[u32; 2], &bool)| {
            let [a, b] = ends.map(|cell| cell as usize);
            let straight = 0.5 * (begin.0.positions[a] + end.0.positions[b]);
            match led {
                true => straight + (begin.1.of_cells[a] - end.1.of_cells[b]) * eighth,
                false => straight,
            }
        };
        middle.ends.iter().zip(&middle.led).map(place).collect()
    }

    /// The mean velocity of a motion over one of its steps, with what finer steps add.
    pub fn mean_velocity(&self, placed: &Placed<'_>, motion: &Motion, step: usize) -> Vector<f64> {
        let index = motion.interval * self.states.rule.steps + step;
        let (of_ends, of_middle) = self.states.rule.weights();
        let at_end = |end: usize| {
            placed.instants[index + end].1.of_cells[motion.cells[step + end] as usize] * of_ends[end]
        };
        let middle =
            motion.middles.get(step).map(|cell| placed.middles[index].1.of_cells[*cell as usize] * of_middle);
        let added = motion.added / (self.states.rule.steps as f64 * self.length(motion.interval));
        at_end(0) + at_end(1) + middle.unwrap_or_else(Vector::zeros) + added
    }

    /// What the model leaves of each step of each motion, over √(T h): motion by motion, step by step.
    pub fn residuals(&self, placed: &Placed<'_>, parameters: &[f64]) -> Vec<Vector<f64>> {
        let (_, displacements) = self.split(parameters);
        let steps = self.states.rule.steps;
        let intervals = 0..self.movie.frames() - 1;
        let drifts: Vec<Vector<f64>> =
            intervals.map(|interval| self.drift(interval, displacements) / steps as f64).collect();
        let of_motion = |motion: &Motion| {
            let first = motion.interval * steps;
            let at = |node: usize| placed.instants[first + node].0.positions[motion.cells[node] as usize];
            let (length, unit) = (self.length(motion.interval), self.unit(motion.interval));
            let residual = |step: usize| {
                let moved = self.mean_velocity(placed, motion, step) * length + drifts[motion.interval];
                (at(step + 1) - at(step) - moved) * unit
            };
            (0..steps).map(residual).collect::<Vec<_>>()
        };
        self.states.motions.par_iter().flat_map_iter(of_motion).collect()
    }

    /// The instants that are frames: index, and the cells as they were measured.
    pub fn frames(&self) -> impl Iterator<Item = (usize, &'a Observation)> + use<'a> {
        let instants = self.states.instants.iter().enumerate();
        instants
            .filter(|(_, instant)| instant.frame.is_some())
            .map(|(index, instant)| (index, &instant.cells))
    }

    /// How far each cell at an instant is from where it was before any fit, x and y of one after the other.
    pub fn nudges(&self, index: usize, displacements: &[f64]) -> Vec<f64> {
        let cells = 0..self.states.instants[index].tracks.len();
        cells
            .flat_map(|cell| <[f64; 2]>::from(self.states.displacement(index, cell, displacements)))
            .collect()
    }

    /// Stiffness of places that were not seen.
    pub fn floor(&self) -> f64 {
        (self.levels.velocity / FAR).powi(2)
    }

    /// Whether each block has a measured position.
    pub fn anchored(&self) -> Vec<bool> {
        let mut anchored = vec![false; self.states.blocks()];
        self.states.anchors.iter().for_each(|place| anchored[*place as usize] = true);
        anchored
    }

    /// The parts of Φ.
    pub fn parts(&self, parameters: &[f64]) -> Result<MovieParts, Error> {
        let placed = self.place(parameters)?;
        let (free, displacements) = self.split(parameters);
        let residual = self.residuals(&placed, parameters).iter().map(|r| r.norm_squared()).sum();
        let nudges = self
            .frames()
            .map(|(index, cells)| {
                let nudged = &placed.instants[index].0;
                let nudges = self.nudges(index, displacements);
                squares(cells, &nudged.tessellation, &nudged.positions, &nudges)
            })
            .sum();
        let unseen = displacements.chunks_exact(2).zip(self.anchored()).filter(|(_, anchored)| !anchored);
        let loose: f64 = unseen.map(|(e, _)| e[0] * e[0] + e[1] * e[1]).sum();
        let priors = self.space.penalty(&self.space.coefficients(free), self.levels.velocity);
        Ok(MovieParts { residual, nudges, floor: self.floor() * loose, priors })
    }

    /// Φ; infinite where there is no tessellation.
    pub fn value(&self, parameters: &[f64]) -> f64 {
        let Ok(parts) = self.parts(parameters) else { return f64::INFINITY };
        let value = parts.residual + self.levels.spring() * parts.nudges + parts.floor + parts.priors;
        if value.is_nan() { f64::INFINITY } else { value }
    }
}

// argmin takes its problem by value: it is given a reference.
impl CostFunction for &MovieObjective<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, parameters: &Vec<f64>) -> Result<f64, ArgminError> {
        Ok(self.value(parameters))
    }
}

impl Jacobian for &MovieObjective<'_> {
    type Param = Vec<f64>;
    type Jacobian = NormalEquations;

    fn jacobian(&self, parameters: &Vec<f64>) -> Result<NormalEquations, ArgminError> {
        Ok(self.linearise(parameters)?)
    }
}
