//! Cells that differ.

use schemars::JsonSchema;
use serde::Serialize;

/// How much cells differ in one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpreadReport {
    /// The parameter.
    #[schemars(extend("enum" = ["K_A", "P_0", "A_0", "alpha"]))]
    pub parameter: String,
    /// Standard deviation over cells as a share of the mean. If the mean cannot be told from zero, as α of an achiral tissue, it means nothing.
    #[schemars(range(min = 0.0))]
    pub relative: f64,
    /// Ends of its 95 % interval; an end that is `null` is not bounded by the data.
    pub ci95: [f64; 2],
    /// Probability of so large a likelihood ratio if cells do not differ in this parameter.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p: f64,
    /// The same for the largest ratio of as many parameters as were let vary.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p_adjusted: f64,
    /// Whether the data show that cells differ: `p_adjusted` below 0.05.
    pub named: bool,
    /// What it says, in words.
    pub words: String,
}
