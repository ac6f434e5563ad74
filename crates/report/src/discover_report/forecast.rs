//! What the cells do next, said before.

use schemars::JsonSchema;
use serde::Serialize;

use super::Gain;
use crate::infer_report::Quantity;

/// Forecasts from frames that no fit has seen, compared with what was then observed. Lists have one entry for each horizon.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ForecastReport {
    /// Indices of the frames from which forecasts start, zero-based.
    pub starts: Vec<usize>,
    /// Horizons: numbers of frames ahead.
    pub horizons: Vec<usize>,
    /// Time between frames.
    pub interval: Quantity,
    /// Number of displacements scored at each horizon.
    pub scored: Vec<usize>,
    /// Skill `1 − Σ‖error‖²/Σ‖displacement‖²`, for displacements since the start.
    pub skill: Forecasters<Gain>,
    /// The same for the mean velocity over the last interval.
    pub velocity_skill: Forecasters<Gain>,
    /// Skill of the extended model minus that of the base model, for the same displacements; `null` if no effect was added.
    pub gain: Option<Vec<Gain>>,
    /// Skill of a perfect forecast, which is limited only by the errors of the measured positions.
    pub best_possible: Vec<f64>,
    /// Root mean square error of a displacement, in `unit`.
    pub error: Forecasters<f64>,
    /// Error that a model itself predicts from the scatter of runs with noise and from position errors, in `unit`; `null` for the baselines.
    pub expected_error: Forecasters<f64>,
    /// Unit of the errors.
    pub unit: String,
    /// The result in a sentence.
    pub words: String,
}

/// One list for each forecast: of the models and of three baselines.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Forecasters<T> {
    /// The base model.
    pub base: Vec<T>,
    /// The model with the effects that were added; `null` if there are none.
    pub extended: Option<Vec<T>>,
    /// Baseline: each cell stays where it is.
    pub no_motion: Vec<T>,
    /// Baseline: each cell keeps its preceding velocity.
    pub constant_velocity: Vec<T>,
    /// Baseline: linear regression on the preceding velocities of a cell and of its neighbours.
    pub regression: Vec<T>,
}

impl<T> Forecasters<T> {
    /// All of them with what they are called.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &[T])> {
        let extended = self.extended.as_deref().map(|own| ("with effects", own));
        let others = [
            ("regression", self.regression.as_slice()),
            ("constant velocity", self.constant_velocity.as_slice()),
            ("no motion", self.no_motion.as_slice()),
        ];
        extended.into_iter().chain([("base model", self.base.as_slice())]).chain(others)
    }
}
