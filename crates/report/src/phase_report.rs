//! `report.json` of the commands `phase-diagram` and `merge`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are written as
//! `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::RunRecord;

/// By how much cells differ in their parameters, and how.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CellSpread {
    /// Standard deviation of each parameter over cells as a share of its mean.
    pub shares: BTreeMap<String, f64>,
    /// Name of the distribution.
    pub distribution: &'static str,
}

/// Everything `phase-diagram` reports. Lengths are in ℓ₀ and rates in K_P.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PhaseReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Cells of each run.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Duration of each run, in 1/K_P.
    pub time: f64,
    /// The time step asked for, in 1/K_P; `null` if each point has the one advised for it.
    pub dt: Option<f64>,
    /// Smallest and largest time step used, in 1/K_P.
    pub steps: [f64; 2],
    /// Least distance between starting positions, in ℓ₀.
    pub least_distance: f64,
    /// Runs at each point.
    #[schemars(range(min = 1))]
    pub replicas: usize,
    /// Area elasticity, in K_P/ℓ₀².
    #[serde(rename = "K_A")]
    pub area_elasticity: f64,
    /// By how much cells differ, if they do.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "CellSpread")]
    pub cell_spread: Option<CellSpread>,
    /// Preferred perimeters of the columns, in ℓ₀.
    #[serde(rename = "P_0")]
    pub preferred_perimeters: Vec<f64>,
    /// Chiralities of the rows.
    #[serde(rename = "alpha")]
    pub chiralities: Vec<f64>,
    /// Which part of the points this is, from one, and of how many.
    #[schemars(inner(range(min = 1)))]
    pub shard: [usize; 2],
    /// Runs made.
    pub runs: usize,
    /// What the quantities range over, in ℓ₀ and 1/K_P.
    pub quantities: BTreeMap<&'static str, QuantityRecord>,
    /// Runs that ended with an error, and why.
    pub failed: Vec<FailedRun>,
    /// Lines to compare with.
    pub lines: PhaseLines,
    /// The scaling of ⟨v²⟩ about the transition; `null` where there are no points for it.
    pub collapse: Option<CollapseRecord>,
    /// Why there is none; `null` if there is one.
    pub no_collapse: Option<String>,
}

/// The values of a quantity over the diagram.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct QuantityRecord {
    /// The least; `null` if no point has a value.
    pub least: Option<Extreme>,
    /// The largest, likewise.
    pub largest: Option<Extreme>,
    /// Points without a value.
    pub unknown: usize,
}

/// An extreme value and where it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Its preferred perimeter.
    #[serde(rename = "P_0")]
    pub preferred_perimeter: f64,
    /// Its chirality.
    #[serde(rename = "alpha")]
    pub chirality: f64,
}

/// A run that ended with an error.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FailedRun {
    /// Its preferred perimeter.
    #[serde(rename = "P_0")]
    pub preferred_perimeter: f64,
    /// Its chirality.
    #[serde(rename = "alpha")]
    pub chirality: f64,
    /// Which run at the point.
    pub replica: usize,
    /// What went wrong.
    pub error: String,
}

/// Lines to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PhaseLines {
    /// P_0* at α = 0 of the paper's P_0* − |α|, measured for |α| ≤ 0.2.
    pub disordered_transition: f64,
    /// P_MF: where the honeycomb becomes unstable, whatever α.
    pub honeycomb_limit: f64,
}

/// The scaling of ⟨v²⟩ about the transition.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CollapseRecord {
    /// Range of |α|.
    pub alpha: [f64; 2],
    /// ⟨v²⟩ from which a point counts as moving.
    pub least_velocity: f64,
    /// Points that count.
    pub points: usize,
    /// Points in the range of |α| that do not move.
    pub at_rest: usize,
    /// The power of |α| by which ⟨v²⟩ is divided.
    pub amplitude_exponent: f64,
    /// The exponents given, or the paper's.
    pub given: GivenExponents,
    /// Those that fit best.
    pub fitted: FittedExponents,
}

/// Exponents as given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct GivenExponents {
    /// The power of |ΔP|.
    pub beta: f64,
    /// The power of |ΔP| in the argument.
    pub phi: f64,
    /// Root mean square distance from one curve in ln ⟨v²⟩; `null` if the curves do not overlap.
    pub scatter: Option<f64>,
}

/// Exponents as fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct FittedExponents {
    /// The power of |ΔP|.
    pub beta: ExponentRecord,
    /// The power of |ΔP| in the argument.
    pub phi: ExponentRecord,
    /// Root mean square distance from one curve in ln ⟨v²⟩.
    pub scatter: f64,
    /// Bootstrap samples behind the intervals.
    pub samples: usize,
}

/// A fitted exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ExponentRecord {
    /// The estimate.
    pub value: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}
