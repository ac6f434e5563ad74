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

use super::memory::Memory;
use super::movie::Movie;
use super::rule::Rule;
use super::states::States;
use crate::{CoefficientSpace, NoiseLevels};
use voronudge_geometry::Vector;
use voronudge_model::Structure;

/// Standard deviation of what nothing holds about where it began, in units of ℓ₀: none to speak of.
const FAR: f64 = 30.0;

/// Standard deviation of the place of a cell that was not seen about the middle of the room that the others leave it, in units of ℓ₀. Without it such
/// cells of measured tissues moved onto their neighbours.
const ROOM: f64 = 0.3;

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

    /// Stiffness of what nothing holds.
    pub fn floor(&self) -> f64 {
        (self.levels.velocity / FAR).powi(2)
    }

    /// Stiffness of places that were not seen.
    pub fn stiffness_of_room(&self) -> f64 {
        (self.levels.velocity / ROOM).powi(2)
    }
}
