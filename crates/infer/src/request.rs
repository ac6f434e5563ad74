//! What a fit is asked.

use crate::coefficients::PREFERRED_AREA;
use crate::{CoefficientSpace, Constraints, Error, Kinds, KnownNoise};
use voronudge_model::{CellParameter, Structure};

/// What to fit, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// What is known of the parameters.
    pub constraints: Constraints,
    /// The model: the terms of the base model, then effects.
    pub structure: Structure,
    /// Labels whose cells have parameters of their own; their columns are part of the structure.
    pub kinds: Option<Kinds>,
    /// Noise levels if known; otherwise they are estimated.
    pub noise: KnownNoise,
    /// How the objective is made small.
    pub method: Method,
    /// Whether to predict velocities left out of the fit.
    pub cross_validation: CrossValidation,
    /// Whether to look for reasons not to trust the measurement.
    pub examination: Examination,
    /// Time between frames where velocities are differences of positions.
    pub frame_interval: Option<f64>,
    /// Whether cells crawl.
    pub activity: Activity,
    /// What may drive the polarities of cells that crawl.
    pub drives: Drives,
    /// Parameters that may differ from cell to cell; for velocities of cells.
    pub varied: Vec<CellParameter>,
    /// Seed of further starts.
    pub seed: u64,
}

/// How the objective is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Levenberg–Marquardt by continuation, flips of contacts, further starts.
    Search {
        /// Steps of the optimiser at each stage.
        max_steps: u64,
        /// Starts in all, at least one.
        starts: usize,
    },
    /// First-order descent, as the paper describes it, for comparison.
    Descent {
        /// Steps in all.
        max_steps: u64,
        /// What is descended.
        loss: Loss,
    },
}

/// The loss of a first-order descent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// `‖v − F‖ + κ ‖ε‖` as the paper prints it: norms, with κ such that both contribute alike.
    Norms,
    /// `‖v − F‖² + k ‖ε‖²`, the likelihood.
    Squares,
}

/// Whether cells crawl: whether what the model leaves of their motion goes on from one frame to the next. For tracks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Activity {
    /// It is new in each interval.
    #[default]
    None,
    /// Each cell has a polarity of its own that it forgets at some rate.
    Polarity,
    /// The same, and it turns towards those of the neighbours.
    Alignment,
}

/// What may drive polarities, beside neighbours and noise: none by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Drives {
    /// They turn away from contacts.
    pub contact_inhibition: bool,
    /// They turn towards the velocity that the model gives.
    pub velocity_alignment: bool,
}

impl Drives {
    /// Whether there are any.
    pub fn any(self) -> bool {
        self.contact_inhibition || self.velocity_alignment
    }
}

/// Whether to predict velocities left out of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrossValidation {
    /// Blocks of cells, or whole frames where there are three or more.
    Done,
    /// Not done.
    Skipped,
}

/// Whether to look for reasons not to trust the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Examination {
    /// Voids, residuals, errors of measurement that the catalogue knows.
    Done,
    /// Not done: the fit is one of many.
    Skipped,
}

impl Request {
    /// A fit of all parameters of the base model with estimated noise. Lengths in units of ℓ₀.
    pub fn new(constraints: Constraints) -> Self {
        Self {
            constraints,
            structure: Structure::base(PREFERRED_AREA),
            kinds: None,
            noise: KnownNoise::default(),
            method: Method::default(),
            cross_validation: CrossValidation::Done,
            examination: Examination::Done,
            frame_interval: None,
            activity: Activity::None,
            drives: Drives::default(),
            varied: Vec::new(),
            seed: 0,
        }
    }

    /// The same with labels whose cells have parameters of their own.
    #[must_use]
    pub fn with_kinds(mut self, kinds: Kinds) -> Self {
        self.structure = self.structure.with(&kinds.columns());
        self.kinds = Some(kinds);
        self
    }

    /// The coefficients that are free.
    pub(crate) fn space(&self) -> Result<CoefficientSpace, Error> {
        Ok(CoefficientSpace::new(&self.constraints)?.with_coefficients(self.structure.dimension()))
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::Search { max_steps: 60, starts: 1 }
    }
}
