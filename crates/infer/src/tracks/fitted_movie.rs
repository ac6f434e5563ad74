//! What a fit of a movie comes to.

use super::memory::Memory;
use super::rule::Rule;
use super::states::States;
use crate::{NoiseLevels, Status};

/// A fitted movie.
pub(super) struct Fit {
    pub states: States,
    pub rule: Rule,
    pub parameters: Vec<f64>,
    pub levels: NoiseLevels,
    pub memory: Option<Memory>,
    pub naive: Vec<f64>,
    pub value: f64,
    pub status: Status,
    pub steps: u64,
    /// Φ / σ_v² after each round.
    pub trace: Vec<f64>,
    /// By how much a finer rule would change the coefficients, the largest change in standard errors.
    pub error: f64,
}
