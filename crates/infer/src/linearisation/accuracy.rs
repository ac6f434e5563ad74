//! How well unknowns are eliminated.

/// How well unknowns are eliminated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// For a step of an optimiser, which the next one sets right.
    OfSteps,
    /// For what is told.
    OfResults,
}
