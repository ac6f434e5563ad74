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
    /// Parameters of the model, in the units above.
    pub parameters: ModelParameters,
    /// Cell size ℓ₀ to which `relative_density` refers, in units of length.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cell_size: f64,
    /// Number of cells in each run.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Number of runs at each density.
    #[schemars(range(min = 2))]
    pub replicas: usize,
    /// Time before the averages, in units of time.
    #[schemars(range(min = 0.0))]
    pub relaxation: f64,
    /// Averaging time, in units of time.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time: f64,
    /// Results at each density, in ascending order of the density.
    #[schemars(length(min = 3))]
    pub points: Vec<UniformRecord>,
}

/// A uniform tissue at one density.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct UniformRecord {
    /// Density ρ, in cells per area.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: f64,
    /// Dimensionless density ρ ℓ₀².
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relative_density: f64,
    /// Pressure p = −(σ_xx + σ_yy)/2, in 1/time; friction is absorbed here and below.
    pub pressure: Measured,
    /// Torque density τ = σ_xy − σ_yx, in 1/time.
    pub torque: Measured,
    /// Mean shape index ⟨P/√A⟩.
    pub shape_index: Measured,
    /// Mean square velocity ⟨v²⟩, in (length/time)².
    pub mean_square_velocity: Measured,
    /// Bulk modulus B = ρ dp/dρ, in 1/time, from the parabola through neighbouring densities.
    pub bulk_modulus: Measured,
    /// Odd bulk modulus A = ½ ρ dτ/dρ, in 1/time, from the parabola through neighbouring densities.
    pub odd_bulk_modulus: Measured,
    /// The honeycomb of this density in mean-field theory; `null` where the theory has none.
    pub honeycomb: Option<Honeycomb>,
}

/// A mean over runs with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Measured {
    /// The mean.
    pub value: f64,
    /// Standard error of the mean.
    pub error: f64,
}

/// Stress and moduli of a honeycomb.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Honeycomb {
    /// Pressure p, in 1/time.
    pub pressure: f64,
    /// Torque density τ, in 1/time.
    pub torque: f64,
    /// Bulk modulus B, in 1/time.
    pub bulk_modulus: f64,
    /// Odd bulk modulus A, in 1/time.
    pub odd_bulk_modulus: f64,
}
