//! What a fit says, in a word and in a sentence.

use schemars::JsonSchema;
use serde::Serialize;

/// The verdict of a fit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Verdict {
    /// The verdict as one word.
    pub kind: VerdictKind,
    /// The verdict as a sentence, which is the headline of the page and the first line on the terminal.
    pub sentence: String,
}

/// The verdict of a fit as one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VerdictKind {
    /// The model misses no more of velocities that it has not seen than measurement noise alone would leave.
    Explained,
    /// The model explains a part; how much of the rest is noise cannot be told, because the noise was estimated from the same fit.
    ExplainedInPart,
    /// The model misses more than noise alone would leave.
    LacksSomething,
    /// The model predicts velocities that it has not seen no better than assuming no motion at all.
    ExplainsNothing,
    /// The data are not what the fit assumes, for example because cells were not seen, tracks are too coarse, or positions are not sites.
    MeasurementMisfit,
    /// The objective is higher than in any acceptable fit.
    NoFit,
}

impl VerdictKind {
    /// Whether the parameters say anything about the tissue.
    #[must_use]
    pub fn is_finding(self) -> bool {
        self != Self::ExplainsNothing
    }
}
