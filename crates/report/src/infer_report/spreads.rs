//! Cells that differ.

use schemars::JsonSchema;
use serde::Serialize;

/// How much cells differ in one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpreadReport {
    /// Name of the parameter.
    #[schemars(extend("enum" = ["K_A", "P_0", "A_0", "alpha"]))]
    pub parameter: String,
    /// Standard deviation over cells as a share of the mean. It means nothing if the mean cannot be distinguished from zero, as for α of an achiral tissue.
    #[schemars(range(min = 0.0))]
    pub relative: f64,
    /// 95 % interval of `relative`; an end that is `null` is not bounded by the data.
    pub ci95: [f64; 2],
    /// Probability of a likelihood ratio at least as large if cells do not differ in this parameter.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p: f64,
    /// `p` adjusted for the number of parameters that were allowed to vary.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p_adjusted: f64,
    /// Whether the data show that cells differ: `p_adjusted` is below 0.05.
    pub named: bool,
    /// The result in words.
    pub words: String,
}
