//! Kinds of cells, told by labels.

use super::Parameters;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Results of a fit for the cells of one label.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KindReport {
    /// The label.
    pub label: i64,
    /// Number of cells with this label, over all frames.
    pub cells: usize,
    /// Whether this is the reference label, with which the others are compared and whose parameters are those of the model.
    pub is_reference: bool,
    /// Parameters of the cells with this label.
    pub parameters: Parameters,
    /// Differences of these parameters from those of the reference label, by name, to first order.
    pub differences: BTreeMap<String, KindDifference>,
    /// Probability of differences at least as large if there are none (χ² of all coefficients of the label).
    pub p: f64,
    /// `p` adjusted for the number of labels that are compared with the reference.
    pub p_adjusted: f64,
    /// Whether the data show a difference: `p_adjusted` is below 0.05.
    pub differs: bool,
    /// The result in words.
    pub words: String,
}

/// Difference of a parameter from that of the reference label, in the unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct KindDifference {
    /// The difference.
    pub value: f64,
    /// 95 % interval of the difference.
    pub ci95: [f64; 2],
}
