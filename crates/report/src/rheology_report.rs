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
    /// Units of length and time of the fits.
    pub units: Units,
    /// Number of cells in each simulated tissue.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Seeds of the starting positions, the same for all fits.
    pub seeds: Vec<u64>,
    /// What `fits[].at` means: the `time` as given, or the mean `frame` of each fit.
    #[schemars(extend("enum" = ["time", "frame"]))]
    pub against: &'static str,
    /// Results for each fit, in the order given.
    pub fits: Vec<FittedRheology>,
}

/// Mechanical response implied by one fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FittedRheology {
    /// Path of the report of `infer`, as given.
    pub path: String,
    /// Time or mean frame of the fit, as `against` says.
    pub at: f64,
    /// Fitted parameters by name, in units of the data.
    pub parameters: BTreeMap<&'static str, f64>,
    /// Cell size ℓ₀, in units of the data.
    pub length_scale: f64,
    /// Number of tissues that came to rest at the fitted parameters.
    pub at_rest: usize,
    /// Number of tissues that flow at the fitted parameters.
    pub flowing: usize,
    /// Number of principal axes of the covariance along which the parameters were moved by one standard error to either side.
    pub axes: usize,
    /// The moduli `B`, `A`, `μ` and `Kᵒ`, in 1/time; if requested also `η` and `ηᵒ`, in units of the friction of a cell.
    pub moduli: Vec<RheologyQuantity>,
    /// Storage and loss moduli at each of `--frequencies`; empty if they were not requested.
    pub dynamic: Vec<RheologyFrequency>,
}

/// Storage and loss moduli at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RheologyFrequency {
    /// Angular frequency ω, in 1/time of the data.
    pub frequency: f64,
    /// μ′, μ″, Kᵒ′ and Kᵒ″, in 1/time, and those of B and A where the tissues are at rest.
    pub moduli: Vec<RheologyQuantity>,
}

/// A measured number with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RheologyQuantity {
    /// Name, for example `shear`, `odd_shear_viscosity` or `shear_loss`.
    pub name: String,
    /// Symbol.
    pub symbol: String,
    /// Mean over the tissues at the fitted parameters.
    pub value: f64,
    /// 95 % interval, from both errors together.
    pub ci95: [f64; 2],
    /// Standard error due to the errors of the fitted parameters.
    pub inference_error: f64,
    /// Standard error of the mean over the simulated tissues.
    pub simulation_error: f64,
    /// Standard deviation between single tissues of this size.
    pub scatter: f64,
    /// Value of the honeycomb at the fitted parameters in mean-field theory; `null` where there is none.
    pub mean_field: Option<f64>,
}
