//! What a fit says, in a word and in a sentence.

use schemars::JsonSchema;
use serde::Serialize;

/// The answer of a fit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Verdict {
    /// In a word.
    pub kind: VerdictKind,
    /// In a sentence, the headline of the page and the first line on the terminal.
    pub sentence: String,
}

/// The answer of a fit in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VerdictKind {
    /// What the model misses of velocities that it has not seen is what the noise of the measurement alone leaves.
    Explained,
    /// The model explains a part; what of the rest is noise cannot be told, because the noise was estimated from the same fit.
    ExplainedInPart,
    /// The model misses more than noise alone would leave.
    LacksSomething,
    /// The model predicts velocities that it has not seen no better than no motion at all.
    ExplainsNothing,
    /// The data are not what the fit takes them for: cells not seen, tracks too coarse, positions that are no sites.
    MeasurementMisfit,
    /// The objective is above any that an acceptable fit has.
    NoFit,
}

impl VerdictKind {
    /// Whether the parameters say anything about the tissue.
    #[must_use]
    pub fn is_finding(self) -> bool {
        self != Self::ExplainsNothing
    }
}
