//! What remains, what noise makes of the data, and how the search was checked.

use schemars::JsonSchema;
use serde::Serialize;

use super::model_fit::HeldOutError;
use super::ranking::Gain;

/// What remains after the last fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Unexplained {
    /// Share of Σ‖v‖² that neither model nor noise explains.
    pub share: f64,
    /// Distance over which the residual stays correlated, in units of length.
    pub correlation_length: f64,
    /// Share of the smooth part of the residual that is free of curl.
    pub divergence_share: f64,
    /// Share of the smooth part of the residual that is free of divergence.
    pub curl_share: f64,
    /// Tests for structure in the residual.
    pub tests: Vec<StructureTest>,
}

/// One test for structure in the residual.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StructureTest {
    /// What is tested, for a reader.
    pub name: String,
    /// The statistic.
    pub statistic: f64,
    /// Probability of so large a statistic of a residual without structure.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p: f64,
}

/// What the squared velocities are made of, in shares of their sum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct NoiseBudget {
    /// The sum Σ‖v‖² over the cells used, in length²/time².
    pub total: f64,
    /// Share that noise of the positions explains.
    pub position_noise: f64,
    /// Share that noise of the velocities explains.
    pub velocity_noise: f64,
    /// Share that the base model explains.
    pub base: f64,
    /// Share that the added effects explain.
    pub effects: f64,
    /// Share that remains. Noise levels are estimates, so it may come out slightly negative.
    pub unexplained: f64,
}

impl NoiseBudget {
    /// Whether any of the shares is known.
    #[must_use]
    pub fn is_known(&self) -> bool {
        let Self { position_noise, velocity_noise, base, effects, unexplained, .. } = *self;
        [position_noise, velocity_noise, base, effects, unexplained].into_iter().any(|share| share > 0.0)
    }
}

/// What effects with a memory were predicted from. They may use velocities of earlier intervals
/// only that share no position with the interval that is explained.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Predictors {
    /// The earlier interval, in words.
    pub interval: String,
    /// How it overlaps the interval that is explained.
    pub overlap: String,
}

/// Synthetic data without an effect, fitted as the data were.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NullSets {
    /// Number of sets fitted.
    pub refitted: usize,
    /// Their seeds.
    pub seeds: Vec<u64>,
}

/// How the search behaved on the null sets.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Calibration {
    /// Probability at which a candidate counts as found.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub level: f64,
    /// What p a single candidate needs to stay within that level over all candidates.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub single_p: f64,
    /// Share of the null sets in which some candidate came below the unadjusted level.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub unadjusted_false_positives: f64,
    /// How the search behaved, in a sentence.
    pub words: String,
}

/// Velocities of another data set predicted with everything as it was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Prediction {
    /// The data set, as given.
    pub dataset: String,
    /// Velocities predicted.
    pub velocities: usize,
    /// Error of the base model; its folds are frames.
    pub before: HeldOutError,
    /// Error with the effects.
    pub after: HeldOutError,
    /// Fall of the error by the effects.
    pub gain: Gain,
}
