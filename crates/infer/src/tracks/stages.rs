//! The stages of a step of integration, and what derivatives of it are made of.

use crate::objective::Nudged;
use voronudge_geometry::Vector;

/// The method of Runge and Kutta: at which share of a step each of its stages is, and what it weighs.
pub(super) const STAGES: [(f64, f64); 4] =
    [(0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];

/// The stage that is the second estimate of the middle of a step.
pub(super) const MIDDLE: usize = 2;

/// Of how many steps at least derivatives of their middle are as good as those of all stages, beside what is left out of both.
const MANY_STEPS: usize = 8;

/// What a slope contributes to derivatives over a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    /// Its weight in them.
    pub weight: f64,
    /// The share of the step over which it leads on to the next slope, or to the end.
    pub onwards: Option<f64>,
}

/// What derivatives of a passage are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Derivatives {
    /// Those of velocities at all stages: exact.
    OfStages,
    /// Those at the middle of each step, held.
    OfMiddle,
}

impl Derivatives {
    /// For so many steps.
    pub fn of(steps: usize) -> Self {
        if steps < MANY_STEPS { Self::OfStages } else { Self::OfMiddle }
    }

    /// The stages whose derivatives are taken, each with what it contributes.
    pub fn parts(self) -> &'static [(usize, &'static [Part])] {
        const fn part(stage: usize) -> Part {
            let onwards = if stage + 1 < STAGES.len() { Some(STAGES[stage + 1].0) } else { None };
            Part { weight: STAGES[stage].1, onwards }
        }
        const OF_STAGES: [(usize, &[Part]); 4] =
            [(0, &[part(0)]), (1, &[part(1)]), (2, &[part(2)]), (3, &[part(3)])];
        const TO_THE_MIDDLE: Part = Part { weight: 0.0, onwards: Some(STAGES[MIDDLE].0) };
        const TO_THE_END: Part = Part { weight: 1.0, onwards: Some(1.0) };
        match self {
            Self::OfStages => &OF_STAGES,
            Self::OfMiddle => &[(MIDDLE, &[TO_THE_MIDDLE, TO_THE_END])],
        }
    }
}

/// Cells at some time, and the velocities that the model gives them.
pub(super) type Stage<'a> = (Nudged<'a>, Vec<Vector<f64>>);
