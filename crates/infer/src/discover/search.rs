//! What to search for, and how.

use crate::{Progress, Request};
use std::ops::ControlFlow;
use voronudge_model::Effect;

/// What to search for, and how.
#[derive(Debug, Clone)]
pub struct Search {
    /// The fit of the base model. With cross-validation the base model and the last are also fitted without the velocities
    /// of each fold; whether an effect is added does not depend on it.
    pub fit: Request,
    /// Candidates, descriptions among them.
    pub candidates: Vec<&'static Effect>,
    /// Probability that data without any effect lead to one.
    pub level: f64,
    /// Synthetic data without an effect that are refitted before one is believed. If not said: 20 where some effect is in
    /// doubt (adjusted p of 10⁻⁴ or more) and there are at most 1000 velocities, none otherwise.
    pub null_sets: Option<usize>,
    /// Effects added at most.
    pub most_effects: usize,
    /// Which tracked cell each cell of each frame is, if cells are tracked; negative for a cell without a name.
    pub identities: Option<Vec<Vec<i64>>>,
    /// Ids of effects of the measurement that were determined before: what they would say is part of the frames.
    pub determined: Vec<&'static str>,
}

impl Search {
    /// The whole catalogue at a level of 5 %.
    pub fn new(fit: Request) -> Self {
        Self {
            fit,
            candidates: Effect::all().iter().collect(),
            level: 0.05,
            null_sets: None,
            most_effects: 4,
            identities: None,
            determined: Vec::new(),
        }
    }
}

/// Told of progress; may stop the search.
pub type Observer<'o> = &'o mut dyn FnMut(Progress<'_>) -> ControlFlow<()>;
