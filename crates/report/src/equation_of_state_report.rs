//! `report.json` of the command `equation-of-state`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are written as `null`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::ModelParameters;
use crate::infer_report::RunRecord;
use crate::units::Units;

/// Everything `equation-of-state` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EquationOfStateReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Parameters of the model, by the names of the interface, in the units above.
    pub parameters: ModelParameters,
    /// The cell size ℓ₀ that `relative_density` refers to.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cell_size: f64,
    /// Cells of each run.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Runs at each density.
    #[schemars(range(min = 2))]
    pub replicas: usize,
    /// Time before the averages.
    #[schemars(range(min = 0.0))]
    pub relaxation: f64,
    /// Time of the averages.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time: f64,
    /// Each density, ascending.
    #[schemars(length(min = 3))]
    pub points: Vec<UniformRecord>,
}

/// A uniform tissue of some density.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct UniformRecord {
    /// Cells per area ρ.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: f64,
    /// ρ ℓ₀².
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relative_density: f64,
    /// p = −(σ_xx + σ_yy)/2, in 1/time: friction is absorbed, here and below.
    pub pressure: Measured,
    /// τ = σ_xy − σ_yx, in 1/time.
    pub torque: Measured,
    /// ⟨P/√A⟩.
    pub shape_index: Measured,
    /// ⟨v²⟩, (length/time)².
    pub mean_square_velocity: Measured,
    /// B = ρ dp/dρ, in 1/time, from the parabola through neighbouring densities.
    pub bulk_modulus: Measured,
    /// A = ½ ρ dτ/dρ, likewise.
    pub odd_bulk_modulus: Measured,
    /// The honeycomb of this density in mean-field theory; `null` where it has none.
    pub honeycomb: Option<Honeycomb>,
}

/// A mean over runs and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Measured {
    /// The mean.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// Stress and moduli of a honeycomb.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Honeycomb {
    /// p, in 1/time.
    pub pressure: f64,
    /// τ, in 1/time.
    pub torque: f64,
    /// B, in 1/time.
    pub bulk_modulus: f64,
    /// A, in 1/time.
    pub odd_bulk_modulus: f64,
}
