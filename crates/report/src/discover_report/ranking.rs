//! What became of every candidate.

use schemars::JsonSchema;
use serde::Serialize;

/// What became of one candidate.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RankedEffect {
    /// Id of the effect.
    pub effect: String,
    /// The family it belongs to.
    pub kind: EffectKind,
    /// Number of coefficients that the data determine.
    pub dimension: usize,
    /// Score statistic against the base model, χ² with `dimension` degrees of freedom if nothing is
    /// missing; `null`, as all numbers are, of what is not testable. Of cells that were put in or taken away: by how much −2 log likelihood falls, beyond what they cost.
    pub statistic: f64,
    /// Probability of so large a statistic if nothing is missing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p: f64,
    /// The same for the largest over all candidates, from refitted null data.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p_adjusted: f64,
    /// Smallest size that would be found in 9 of 10 cases, in percent of the velocity (rms).
    pub detection_limit: f64,
    /// Estimated size when added alone, in percent of the velocity (rms).
    pub size: f64,
    /// 95 % interval of the size; `null` where it is not known.
    pub size_ci95: Option<[f64; 2]>,
    /// By how much the held-out error falls when it is added alone; `null` unless it is the one effect that was selected.
    pub gain: Option<Gain>,
    /// What became of it.
    pub status: CandidateStatus,
    /// Why it was taken or not, in a sentence.
    pub reason: String,
}

/// By how much an error falls, or velocities held out become more probable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Gain {
    /// The fall.
    pub value: f64,
    /// Its standard error over the folds.
    pub standard_error: f64,
}

impl From<[f64; 2]> for Gain {
    fn from([value, standard_error]: [f64; 2]) -> Self {
        Self { value, standard_error }
    }
}

/// What became of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CandidateStatus {
    /// Something that the measurement does, found before the search and taken into account by all fits.
    Measurement,
    /// Added to the model.
    Selected,
    /// Cannot be told from a selected effect.
    Alias,
    /// Tested and not taken.
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

/// The family an effect belongs to.
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
    /// Something measured beside the motion: labels, supplied fields.
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
