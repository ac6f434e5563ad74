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
    /// Frames measured, zero-based.
    pub frames: Vec<usize>,
    /// Cells seen in each.
    pub seen: Vec<usize>,
    /// Those of them that count: whose polygon and those of whose neighbours are certain.
    pub counted: Vec<usize>,
    /// The cell size: root of the mean area of the cells that count.
    pub length_scale: Quantity,
    /// Whether velocities were given, or are displacements.
    #[schemars(extend("enum" = ["given", "from_positions", "none"]))]
    pub velocities: &'static str,
    /// Whether the median motion of the cells is taken for one of the stage.
    pub common_motion_removed: bool,
    /// Shapes as a nematic.
    pub nematic: ObservedNematic,
    /// Avalanches of T1 transitions; `null` if there are no transitions.
    pub avalanches: Option<ObservedAvalanches>,
    /// Single numbers, by name.
    pub numbers: BTreeMap<&'static str, ObservedNumber>,
    /// Functions, by name.
    pub curves: BTreeMap<&'static str, ObservedCurve>,
}

/// The director and its defects.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedNematic {
    /// Standard deviation of the Gaussian over which shapes are smoothed.
    pub smoothing_width: Quantity,
    /// Defects of +½ in the frames that are measured.
    pub plus: usize,
    /// Those of −½.
    pub minus: usize,
    /// Parameters of the model whose stresses are averaged around defects; `null` if none are.
    pub stress_of: Option<ModelParameters>,
}

/// T1 transitions that come together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedAvalanches {
    /// Longest time between two that do.
    pub threshold: Quantity,
    /// How many avalanches there are, of transitions that touch.
    pub avalanches: usize,
    /// How many bursts, of transitions anywhere.
    pub bursts: usize,
}

/// A measured number.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedNumber {
    /// Value.
    pub value: f64,
    /// Standard error; `null` where it cannot be told.
    pub standard_error: f64,
    /// Unit.
    pub unit: String,
    /// What it rests on: cells, pairs of cells, transitions or frames.
    pub count: usize,
}

/// A measured function.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ObservedCurve {
    /// What it is a function of.
    pub axis: &'static str,
    /// Unit of that.
    pub axis_unit: String,
    /// Unit of the values.
    pub unit: String,
    /// Lags, distances, wave numbers or values.
    pub at: Vec<f64>,
    /// Values.
    pub value: Vec<f64>,
    /// Standard errors; `null` where they cannot be told.
    pub standard_error: Vec<f64>,
    /// Cells, pairs, displacements or wave vectors that each rests on.
    pub count: Vec<usize>,
}
