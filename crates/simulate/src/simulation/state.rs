//! What a simulation is made of from step to step.

use crate::headings::Headings;
use serde::{Deserialize, Serialize};
use voronudge_geometry::{Scalar, Vector};

/// All that a simulation needs to go on, besides what it was made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct State<S: Scalar = f64> {
    /// Time since the start.
    pub time: f64,
    /// Steps made, of the adaptive method parts of steps.
    pub steps: u64,
    /// How often a cell came to be behind a wall, and was put in front of it.
    #[serde(default)]
    pub crossings: u64,
    /// The next part of a step of the adaptive method.
    pub part: Option<f64>,
    /// Cell centres (N), unwrapped, in the unit of the box.
    #[serde(skip)]
    pub positions: Vec<Vector<S>>,
    /// Directions of self-propulsion (N, radians), or none.
    #[serde(skip)]
    pub headings: Vec<S>,
    /// Speeds of self-propulsion over `v₀` (N), or none if these do not vary.
    #[serde(skip)]
    pub speeds: Vec<S>,
}

impl<S: Scalar> Default for State<S> {
    fn default() -> Self {
        Self {
            time: 0.0,
            steps: 0,
            crossings: 0,
            part: None,
            positions: Vec::new(),
            headings: Vec::new(),
            speeds: Vec::new(),
        }
    }
}

impl<S: Scalar> State<S> {
    pub(super) fn polarities(&self) -> Headings<S> {
        Headings { angles: self.headings.clone(), speeds: self.speeds.clone() }
    }

    pub(super) fn set_polarities(&mut self, headings: &Headings<S>) {
        self.headings.clone_from(&headings.angles);
        self.speeds.clone_from(&headings.speeds);
    }
}

/// Work space of one step.
#[derive(Debug, Clone)]
pub(super) struct Stage<S: Scalar> {
    pub positions: Vec<Vector<S>>,
    pub headings: Headings<S>,
    pub slopes: [Vec<Vector<S>>; 3],
}

impl<S: Scalar> Default for Stage<S> {
    fn default() -> Self {
        Self { positions: Vec::new(), headings: Headings::default(), slopes: Default::default() }
    }
}
