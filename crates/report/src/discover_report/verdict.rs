//! The answer of `discover` as one word.

use schemars::JsonSchema;
use serde::Serialize;

/// The answer as one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The base model leaves nothing but noise.
    NothingMissing,
    /// One class of effects explains what the base model lacks.
    Attributed,
    /// An effect explains part of what the base model lacks.
    Partial,
    /// Something with a structure is missing, and no candidate explains it.
    UnexplainedStructured,
    /// Something without structure is missing.
    UnexplainedWhite,
    /// The data cannot decide.
    NotTestable,
}

impl Verdict {
    /// The verdict for a heading.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NothingMissing => "nothing missing",
            Self::Attributed => "attributed",
            Self::Partial => "partly attributed",
            Self::UnexplainedStructured => "unexplained, with structure",
            Self::UnexplainedWhite => "unexplained, without structure",
            Self::NotTestable => "not testable",
        }
    }

    /// What it means and what it does not mean.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::NothingMissing => {
                "The base model leaves no more than the measurement noise explains, so nothing was added. \
                 Effects below their detection limits may still be there: the limits are in the ranking."
            }
            Self::Attributed => {
                "The effect was selected against all other candidates, predicts data that the fit has not \
                 seen better, explains at least 80 % of what the base model lacked, and the extended model \
                 fits down to the noise. It does not follow that no other mechanism could do the same: only \
                 the candidates listed were compared, and those of one class cannot be told apart."
            }
            Self::Partial => {
                "An effect was selected, but it explains less than 80 % of what the base model lacked, the \
                 extended model still does not fit, or data that the fit has not seen are not predicted better \
                 by more than a standard error. The data are consistent with it; it is not shown to be the \
                 cause."
            }
            Self::UnexplainedStructured => {
                "The base model lacks something that is structured in space, and no candidate explains it. \
                 Maps and correlation functions say what it looks like, not what it is."
            }
            Self::UnexplainedWhite => {
                "The base model leaves more than the stated noise, but the rest differs from cell to cell \
                 without structure. More measurement noise than stated, or motion that is random for each \
                 cell, looks like this."
            }
            Self::NotTestable => {
                "These data cannot decide: the effects in question are below their detection limits, or \
                 cannot be told from the parameters of the base model. This is neither evidence for an effect \
                 nor against one."
            }
        }
    }
}
