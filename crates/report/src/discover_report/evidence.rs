//! What remains, what noise makes of the data, and how the search was checked.

use schemars::JsonSchema;
use serde::Serialize;

use super::model_fit::HeldOutError;
use super::ranking::Gain;

/// What remains unexplained after the last fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Unexplained {
    /// Share of Σ‖v‖² that neither the model nor noise explains.
    pub share: f64,
    /// Distance over which the residuals stay correlated, in units of length; `null` where it is not known.
    pub correlation_length: f64,
    /// Share of the smooth part of the residuals that is free of curl; `null` if there is no significant smooth part.
    pub divergence_share: f64,
    /// Share of the smooth part of the residuals that is free of divergence; `null` if there is no significant smooth part.
    pub curl_share: f64,
    /// Tests for structure in the residuals.
    pub tests: Vec<StructureTest>,
}

/// One test for structure in the residuals.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StructureTest {
    /// What is tested, in words.
    pub name: String,
    /// The test statistic.
    pub statistic: f64,
    /// Probability of a statistic at least as large for residuals without structure.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p: f64,
}

/// Composition of the squared velocities, as shares of their sum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct NoiseBudget {
    /// The sum Σ‖v‖² over the cells used, in length²/time².
    pub total: f64,
    /// Share that is explained by noise of the positions.
    pub position_noise: f64,
    /// Share that is explained by noise of the velocities.
    pub velocity_noise: f64,
    /// Share that is explained by the base model.
    pub base: f64,
    /// Share that is explained by the added effects.
    pub effects: f64,
    /// Share that remains unexplained. It may be slightly negative, because noise levels are estimates.
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

/// The earlier velocities from which effects with a memory were predicted. Only intervals are used that share no time with the interval that is explained.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Predictors {
    /// The earlier interval, in words.
    pub interval: String,
    /// How it overlaps with the interval that is explained.
    pub overlap: String,
}

/// Synthetic data sets without an effect, fitted in the same way as the data.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NullSets {
    /// Number of sets fitted.
    pub refitted: usize,
    /// Seeds of the sets.
    pub seeds: Vec<u64>,
}

/// How the search behaved on the null sets.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Calibration {
    /// Significance level at which a candidate counts as found.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub level: f64,
    /// The p that a single candidate needs for that level to hold over all candidates.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub single_p: f64,
    /// Share of the null sets in which the p of some candidate was below the unadjusted level; `null` without null sets.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub unadjusted_false_positives: f64,
    /// How the search behaved, in a sentence.
    pub words: String,
}

/// Prediction of the velocities of another data set, with everything as it was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Prediction {
    /// The data set, as given.
    pub dataset: String,
    /// Number of velocities predicted.
    pub velocities: usize,
    /// Error of the base model, with frames as folds.
    pub before: HeldOutError,
    /// Error of the model with the effects, with frames as folds.
    pub after: HeldOutError,
    /// Reduction of the error by the effects.
    pub gain: Gain,
}
