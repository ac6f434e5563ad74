//! `report.json` of the command `phase-diffusion`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are written as `null`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::{Quantity, RunRecord};
use crate::units::Units;

/// Everything `phase-diffusion` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PhaseDiffusionReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Frames used, zero-based.
    pub frames: Vec<usize>,
    /// Cells present in all frames used.
    pub cells: usize,
    /// The cell size ℓ₀, ℓ₀² = area of the box per cell.
    pub length_scale: Quantity,
    /// Whether the places without displacement were given, or a constant displacement was fitted (`free`).
    #[schemars(extend("enum" = ["given", "free"]))]
    pub reference: &'static str,
    /// What the residuals are taken for.
    #[schemars(extend("enum" = ["measurement", "driving"]))]
    pub fluctuations: &'static str,
    /// The highest power of the wave vector in the rates.
    #[schemars(extend("enum" = ["second", "fourth"]))]
    pub order: &'static str,
    /// Phase diffusivities of the paper's equation, ε_xy = +1.
    pub diffusivities: Diffusivities,
    /// Moduli over the friction of a cell that they imply: rates.
    pub moduli: ImpliedModuli,
    /// √χ² of both cross diffusivities together, two degrees of freedom: their distance from none in standard errors.
    pub chirality_significance: f64,
    /// Root mean square of the residuals of the displacement amplitudes, in units of length.
    pub residual: f64,
    /// Share of the changes of the amplitudes that the equation explains.
    pub explained: f64,
    /// Correlation of residuals from frame to frame.
    pub residual_correlation: f64,
    /// The wave vectors used.
    pub wave_vectors: Vec<WaveVectorRecord>,
}

/// The four phase diffusivities.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct Diffusivities {
    /// D_∥.
    pub D_parallel: Diffusivity,
    /// D_⊥.
    pub D_perp: Diffusivity,
    /// D_∥^×.
    pub D_parallel_cross: Diffusivity,
    /// D_⊥^×.
    pub D_perp_cross: Diffusivity,
}

/// An estimate of a diffusivity.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Diffusivity {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Unit.
    pub unit: String,
}

/// Moduli, per friction where they come from diffusivities.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ImpliedModuli {
    /// Bulk modulus.
    pub B: Quantity,
    /// Odd bulk modulus.
    pub A: Quantity,
    /// Shear modulus.
    pub mu: Quantity,
    /// Odd shear modulus.
    pub K_o: Quantity,
}

/// One wave vector.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WaveVectorRecord {
    /// Its components, in 1/length.
    pub q: [f64; 2],
    /// Root mean square amplitude of the displacement over the frames, in units of length.
    pub amplitude: f64,
    /// D(q) of this wave vector alone, in components along q and a quarter turn ahead; `null` where it is not determined.
    pub matrix: Option<[[f64; 2]; 2]>,
    /// Standard errors of its entries, likewise.
    pub standard_errors: Option<[[f64; 2]; 2]>,
}
