//! `report.json` of `voronudge observe`.

use crate::ModelParameters;
use crate::infer_report::{Quantity, RunRecord};
use crate::units::Units;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Everything `observe` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObserveReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Indices of the frames measured, zero-based.
    pub frames: Vec<usize>,
    /// Number of cells seen in each of these frames.
    pub seen: Vec<usize>,
    /// Number of cells that count in each of these frames: their polygon and those of their neighbours are certain.
    pub counted: Vec<usize>,
    /// Cell size: the square root of the mean area of the cells that count.
    pub length_scale: Quantity,
    /// Where the velocities come from: the data (`given`), displacements between frames (`from_positions`), or nowhere (`none`).
    #[schemars(extend("enum" = ["given", "from_positions", "none"]))]
    pub velocities: &'static str,
    /// Whether the median motion of the cells was attributed to the stage and removed.
    pub common_motion_removed: bool,
    /// Cell shapes as a nematic: the director and its defects.
    pub nematic: ObservedNematic,
    /// Avalanches of T1 transitions; `null` if there are no transitions.
    pub avalanches: Option<ObservedAvalanches>,
    /// Measured numbers, by name.
    pub numbers: BTreeMap<&'static str, ObservedNumber>,
    /// Measured functions, by name.
    pub curves: BTreeMap<&'static str, ObservedCurve>,
}

/// The director of the cell shapes and its defects.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedNematic {
    /// Standard deviation of the Gaussian that smooths cell shapes to a director.
    pub smoothing_width: Quantity,
    /// Number of +½ defects in the frames measured.
    pub plus: usize,
    /// Number of −½ defects in the frames measured.
    pub minus: usize,
    /// Parameters of the model whose stresses are averaged around defects; `null` if no stresses are averaged.
    pub stress_of: Option<ModelParameters>,
}

/// T1 transitions that belong together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedAvalanches {
    /// Longest time between two transitions that belong together.
    pub threshold: Quantity,
    /// Number of avalanches: groups of transitions whose cells touch.
    pub avalanches: usize,
    /// Number of bursts: groups of transitions anywhere in the field.
    pub bursts: usize,
}

/// A measured number.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedNumber {
    /// Value.
    pub value: f64,
    /// Standard error; `null` where it cannot be determined.
    pub standard_error: f64,
    /// Unit.
    pub unit: String,
    /// Number of cells, pairs of cells, transitions or frames on which the value is based.
    pub count: usize,
}

/// A measured function.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedCurve {
    /// The variable that it is a function of.
    pub axis: &'static str,
    /// Unit of this variable.
    pub axis_unit: String,
    /// Unit of the values.
    pub unit: String,
    /// Values of the variable: lags, distances, wave numbers or values of a quantity.
    pub at: Vec<f64>,
    /// Value of the function at each of these.
    pub value: Vec<f64>,
    /// Standard error of each value; `null` where it cannot be determined.
    pub standard_error: Vec<f64>,
    /// Number of cells, pairs, displacements or wave vectors on which each value is based.
    pub count: Vec<usize>,
}
