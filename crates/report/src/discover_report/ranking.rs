//! What became of every candidate.

use schemars::JsonSchema;
use serde::Serialize;

/// Result for one candidate.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RankedEffect {
    /// ID of the effect.
    pub effect: String,
    /// Family of the effect.
    pub kind: EffectKind,
    /// Number of coefficients that the data determine.
    pub dimension: usize,
    /// Score statistic against the base model, χ² with `dimension` degrees of freedom if nothing is missing; for cells that were added or removed, the fall of
    /// −2 log likelihood beyond their cost. `null`, like the numbers below, if the candidate cannot be tested.
    pub statistic: f64,
    /// Probability of a statistic at least as large if nothing is missing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p: f64,
    /// The same for the largest statistic of all candidates, from refitted null data.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p_adjusted: f64,
    /// Smallest size that would be found in 9 of 10 cases, in percent of the root mean square velocity.
    pub detection_limit: f64,
    /// Estimated size when the effect is added alone, in percent of the root mean square velocity.
    pub size: f64,
    /// 95 % interval of `size`; `null` where it is not known.
    pub size_ci95: Option<[f64; 2]>,
    /// Reduction of the held-out error when the effect is added alone; `null` unless it is the only effect that was selected.
    pub gain: Option<Gain>,
    /// Outcome for the candidate.
    pub status: CandidateStatus,
    /// Why it was selected or not, in a sentence.
    pub reason: String,
}

/// Reduction of an error, gain in the log probability of held-out velocities, or skill of a forecast.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Gain {
    /// The reduction, gain or skill.
    pub value: f64,
    /// Standard error of `value`, over the folds.
    pub standard_error: f64,
}

impl From<[f64; 2]> for Gain {
    fn from([value, standard_error]: [f64; 2]) -> Self {
        Self { value, standard_error }
    }
}

/// Outcome for a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CandidateStatus {
    /// A property of the measurement, found before the search and taken into account by all fits.
    Measurement,
    /// Added to the model.
    Selected,
    /// Cannot be distinguished from a selected effect.
    Alias,
    /// Tested and not selected.
    BelowThreshold,
    /// Cannot be tested with these data.
    NotTestable,
    /// A generic description, which is never named as a mechanism.
    Description,
}

impl CandidateStatus {
    /// The status for a table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Measurement => "measurement",
            Self::Selected => "selected",
            Self::Alias => "alias",
            Self::BelowThreshold => "below threshold",
            Self::NotTestable => "not testable",
            Self::Description => "description",
        }
    }
}

/// Family of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EffectKind {
    /// Motion of the whole field of view: drift, expansion, rotation, shear, distortion.
    Motion,
    /// Forces and torques within and between cells.
    Force,
    /// A coefficient that differs from place to place or from cell to cell.
    Gradient,
    /// A response to earlier motion.
    History,
    /// How the velocities and positions were measured.
    Observation,
    /// Something measured in addition to the motion: labels, supplied fields.
    Measured,
    /// Forces on a free edge.
    Boundary,
    /// A generic description, never a mechanism.
    Description,
}

impl EffectKind {
    /// The family for a table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Force => "force",
            Self::Gradient => "gradient",
            Self::History => "history",
            Self::Observation => "observation",
            Self::Measured => "measured",
            Self::Boundary => "boundary",
            Self::Description => "description",
        }
    }
}
