//! What the cells do next, said before.

use schemars::JsonSchema;
use serde::Serialize;

use super::Gain;
use crate::infer_report::Quantity;

/// Forecasts from frames that no fit has seen, against what was seen then. Lists have one entry for each horizon.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ForecastReport {
    /// Frames of the data set from which forecasts start.
    pub starts: Vec<usize>,
    /// Frames ahead.
    pub horizons: Vec<usize>,
    /// Time of a frame.
    pub interval: Quantity,
    /// Displacements scored.
    pub scored: Vec<usize>,
    /// `1 − Σ‖error‖²/Σ‖displacement‖²` of displacements since the start.
    pub skill: Forecasters<Gain>,
    /// The same of the mean velocity over the last interval.
    pub velocity_skill: Forecasters<Gain>,
    /// Skill of the extended model less that of the base model, from the same displacements; `null` if nothing was added.
    pub gain: Option<Vec<Gain>>,
    /// Skill of who knows where cells go but not by how much their places are seen wrong.
    pub best_possible: Vec<f64>,
    /// Root mean square error of a displacement.
    pub error: Forecasters<f64>,
    /// What it should be by the models themselves: by the scatter of runs with noise, and the errors of positions. Nothing of baselines.
    pub expected_error: Forecasters<f64>,
    /// Unit of the errors.
    pub unit: String,
    /// What it comes to, in a sentence.
    pub words: String,
}

/// One list for each who says what comes next.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Forecasters<T> {
    /// The base model.
    pub base: Vec<T>,
    /// The model with the effects that were added; `null` if there are none.
    pub extended: Option<Vec<T>>,
    /// Each cell stays where it is.
    pub no_motion: Vec<T>,
    /// Each cell keeps the velocity that it had.
    pub constant_velocity: Vec<T>,
    /// Linear regression on the velocities that a cell and its neighbours had.
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
