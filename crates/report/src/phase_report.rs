//! `report.json` of the commands `phase-diagram` and `merge`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are written as
//! `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::RunRecord;

/// How much the cells differ in their parameters, and how the values are distributed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CellSpread {
    /// Standard deviation over the cells as a share of the mean, by name of the parameter.
    pub shares: BTreeMap<String, f64>,
    /// Distribution of the values: `normal`, `log-normal` or `two-types`.
    pub distribution: &'static str,
}

/// Everything `phase-diagram` reports. Lengths are in ℓ₀ and rates in K_P.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PhaseReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Number of cells in each run.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Duration of each run, in 1/K_P.
    pub time: f64,
    /// Time step requested for all points, in 1/K_P; `null` if each point uses the step advised for it.
    pub dt: Option<f64>,
    /// Smallest and largest time step used, in 1/K_P.
    pub steps: [f64; 2],
    /// Least distance between the random starting positions, in ℓ₀.
    pub least_distance: f64,
    /// Number of runs at each point.
    #[schemars(range(min = 1))]
    pub replicas: usize,
    /// Area elasticity, in K_P/ℓ₀².
    #[serde(rename = "K_A")]
    pub area_elasticity: f64,
    /// How much the cells differ in their parameters; missing if they do not differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "CellSpread")]
    pub cell_spread: Option<CellSpread>,
    /// Preferred perimeters of the columns of the diagram, in ℓ₀.
    #[serde(rename = "P_0")]
    pub preferred_perimeters: Vec<f64>,
    /// Chiralities of the rows of the diagram.
    #[serde(rename = "alpha")]
    pub chiralities: Vec<f64>,
    /// Number of this part of the diagram, counted from one, and the number of parts; both are 1 for a whole diagram.
    #[schemars(inner(range(min = 1)))]
    pub shard: [usize; 2],
    /// Number of runs made, including those that failed.
    pub runs: usize,
    /// Range of each quantity over the diagram, by name of the quantity, in units of ℓ₀ and 1/K_P.
    pub quantities: BTreeMap<&'static str, QuantityRecord>,
    /// Runs that ended with an error, and the reason.
    pub failed: Vec<FailedRun>,
    /// Reference lines to compare the diagram with.
    pub lines: PhaseLines,
    /// Test of the scaling of ⟨v²⟩ about the transition; `null` where the diagram does not have the points for it.
    pub collapse: Option<CollapseRecord>,
    /// Why `collapse` is `null`; `null` if it is not.
    pub no_collapse: Option<String>,
}

/// Range of a quantity over the diagram.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct QuantityRecord {
    /// Smallest value and where it occurs; `null` if no point has a value.
    pub least: Option<Extreme>,
    /// Largest value and where it occurs; `null` if no point has a value.
    pub largest: Option<Extreme>,
    /// Number of points without a value.
    pub unknown: usize,
}

/// An extreme value and the point at which it occurs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Extreme {
    /// The value, in units of ℓ₀ and 1/K_P.
    pub value: f64,
    /// Preferred perimeter of the point, in ℓ₀.
    #[serde(rename = "P_0")]
    pub preferred_perimeter: f64,
    /// Chirality of the point.
    #[serde(rename = "alpha")]
    pub chirality: f64,
}

/// A run that ended with an error.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FailedRun {
    /// Preferred perimeter of the run, in ℓ₀.
    #[serde(rename = "P_0")]
    pub preferred_perimeter: f64,
    /// Chirality of the run.
    #[serde(rename = "alpha")]
    pub chirality: f64,
    /// Index of the run at its point, zero-based.
    pub replica: usize,
    /// What went wrong, in words.
    pub error: String,
}

/// Reference lines to compare a phase diagram with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PhaseLines {
    /// P_0* at α = 0, in ℓ₀: the paper's transition line is P_0* − |α|, measured for |α| ≤ 0.2.
    pub disordered_transition: f64,
    /// P_MF, in ℓ₀: the preferred perimeter at which the honeycomb becomes unstable, for any α.
    pub honeycomb_limit: f64,
}

/// Test of the scaling of ⟨v²⟩ about the transition.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CollapseRecord {
    /// Range of |α| in which the scaling is tested.
    pub alpha: [f64; 2],
    /// Least ⟨v²⟩ for a point to count as moving, in (ℓ₀ K_P)².
    pub least_velocity: f64,
    /// Number of moving points in the range of |α|, which are used.
    pub points: usize,
    /// Number of points in the range of |α| that do not move.
    pub at_rest: usize,
    /// Power of |α| by which ⟨v²⟩ is divided.
    pub amplitude_exponent: f64,
    /// Result with the exponents given, by default those of the paper.
    pub given: GivenExponents,
    /// Result with the exponents that fit best.
    pub fitted: FittedExponents,
}

/// Exponents as given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct GivenExponents {
    /// β, the power of |ΔP| by which ⟨v²⟩ is scaled.
    pub beta: f64,
    /// φ, the power of |ΔP| in the argument |α|/|ΔP|^φ.
    pub phi: f64,
    /// Root mean square distance of the points from one curve, in ln ⟨v²⟩; `null` if the curves do not overlap.
    pub scatter: Option<f64>,
}

/// Exponents as fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct FittedExponents {
    /// β, the power of |ΔP| by which ⟨v²⟩ is scaled.
    pub beta: ExponentRecord,
    /// φ, the power of |ΔP| in the argument |α|/|ΔP|^φ.
    pub phi: ExponentRecord,
    /// Root mean square distance of the points from one curve, in ln ⟨v²⟩.
    pub scatter: f64,
    /// Number of bootstrap samples from which the intervals are taken.
    pub samples: usize,
}

/// A fitted exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ExponentRecord {
    /// The estimate.
    pub value: f64,
    /// 95 % interval of the estimate.
    pub interval: [f64; 2],
}
