//! `report.json` of the command `rheology`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are written as `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::RunRecord;
use crate::units::Units;

/// Everything `rheology` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RheologyReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of the fits.
    pub units: Units,
    /// Cells of each simulated tissue.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Seeds of the starting positions, the same for all fits.
    pub seeds: Vec<u64>,
    /// What `fits[].at` is: `time` as given, or the mean `frame` of each fit.
    #[schemars(extend("enum" = ["time", "frame"]))]
    pub against: &'static str,
    /// Each fit, in the order given.
    pub fits: Vec<FittedRheology>,
}

/// What one fit implies.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FittedRheology {
    /// The report of `infer`, as given.
    pub path: String,
    /// Where it stands: time or frame.
    pub at: f64,
    /// Parameters as fitted, in units of the data, by the names of the interface.
    pub parameters: BTreeMap<&'static str, f64>,
    /// The cell size ℓ₀, in units of the data.
    pub length_scale: f64,
    /// Tissues at the fitted parameters that came to rest.
    pub at_rest: usize,
    /// Tissues at the fitted parameters that flow.
    pub flowing: usize,
    /// Principal axes of the covariance along which the parameters were moved by one standard error to either side.
    pub axes: usize,
    /// `B`, `A`, `μ`, `Kᵒ` in 1/time; where asked for, `η` and `ηᵒ` in units of the friction of a cell.
    pub moduli: Vec<RheologyQuantity>,
    /// Storage and loss moduli at each of `--frequencies`; empty if not asked for.
    pub dynamic: Vec<RheologyFrequency>,
}

/// Storage and loss moduli at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RheologyFrequency {
    /// Angular frequency ω, in 1/time of the data.
    pub frequency: f64,
    /// μ′, μ″, Kᵒ′, Kᵒ″, and those of B and A where the tissues are at rest.
    pub moduli: Vec<RheologyQuantity>,
}

/// A measured number with what is not known of it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RheologyQuantity {
    /// For example `shear`, `odd_shear_viscosity` or `shear_loss`.
    pub name: String,
    /// Symbol.
    pub symbol: String,
    /// Mean over tissues at the fitted parameters.
    pub value: f64,
    /// 95 % interval, from both errors together.
    pub ci95: [f64; 2],
    /// Standard error that the errors of the parameters make.
    pub inference_error: f64,
    /// Standard error of the mean over the tissues that were simulated.
    pub simulation_error: f64,
    /// Standard deviation from one tissue of this size to another.
    pub scatter: f64,
    /// The value of the honeycomb at the fitted parameters in mean-field theory; `null` where there is none.
    pub mean_field: Option<f64>,
}
