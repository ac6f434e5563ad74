//! Kinds of cells, told by labels.

use super::Parameters;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// What a fit says of the cells of one label.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KindReport {
    /// The label.
    pub label: i64,
    /// Cells that have it, in all frames.
    pub cells: usize,
    /// Whether it is the label that others are compared with, whose parameters are those of the model.
    pub is_reference: bool,
    /// Parameters of its cells.
    pub parameters: Parameters,
    /// By how much these exceed those of the reference, by name, to first order.
    pub differences: BTreeMap<String, KindDifference>,
    /// Probability of so large differences if there are none (χ² of all coefficients of the label).
    pub p: f64,
    /// The same for the largest of as many labels as are compared.
    pub p_adjusted: f64,
    /// Whether the data show a difference: `p_adjusted` below 0.05.
    pub differs: bool,
    /// What it says, in words.
    pub words: String,
}

/// A difference, in the unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct KindDifference {
    /// Its value.
    pub value: f64,
    /// Ends of its 95 % interval.
    pub ci95: [f64; 2],
}
