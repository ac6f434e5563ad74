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
    /// Indices of the frames used, zero-based.
    pub frames: Vec<usize>,
    /// Number of cells that are present in all frames used.
    pub cells: usize,
    /// Cell size ℓ₀; ℓ₀² is the area of the box per cell.
    pub length_scale: Quantity,
    /// Whether the positions without displacement were given (`given`) or a constant displacement was fitted (`free`).
    #[schemars(extend("enum" = ["given", "free"]))]
    pub reference: &'static str,
    /// What the residuals are attributed to: errors of measurement (`measurement`) or random driving forces (`driving`).
    #[schemars(extend("enum" = ["measurement", "driving"]))]
    pub fluctuations: &'static str,
    /// Highest power of the wave vector in the relaxation rates.
    #[schemars(extend("enum" = ["second", "fourth"]))]
    pub order: &'static str,
    /// Phase diffusivities of the paper's equation, with ε_xy = +1.
    pub diffusivities: Diffusivities,
    /// Moduli over the friction of a cell that the diffusivities imply, in 1/time.
    pub moduli: ImpliedModuli,
    /// √χ² of both cross diffusivities together against zero, with two degrees of freedom: their distance from zero in standard errors.
    pub chirality_significance: f64,
    /// Root mean square residual of the displacement amplitudes, in units of length.
    pub residual: f64,
    /// Share of the squared changes of the amplitudes that the equation explains.
    pub explained: f64,
    /// Correlation between the residuals of consecutive frames.
    pub residual_correlation: f64,
    /// Results for each wave vector used.
    pub wave_vectors: Vec<WaveVectorRecord>,
}

/// The four phase diffusivities.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct Diffusivities {
    /// D_∥ = B/ζ.
    pub D_parallel: Diffusivity,
    /// D_⊥ = μ/ζ.
    pub D_perp: Diffusivity,
    /// D_∥^× = −A/ζ.
    pub D_parallel_cross: Diffusivity,
    /// D_⊥^× = Kᵒ/ζ.
    pub D_perp_cross: Diffusivity,
}

/// An estimated diffusivity.
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

/// Moduli over the friction of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ImpliedModuli {
    /// Bulk modulus B.
    pub B: Quantity,
    /// Odd bulk modulus A.
    pub A: Quantity,
    /// Shear modulus μ.
    pub mu: Quantity,
    /// Odd shear modulus Kᵒ.
    pub K_o: Quantity,
}

/// Results for one wave vector.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WaveVectorRecord {
    /// Components of the wave vector, in 1/length.
    pub q: [f64; 2],
    /// Root mean square displacement amplitude over the frames, in units of length.
    pub amplitude: f64,
    /// D(q) from this wave vector alone, in 1/time, rows first, in components along q and a quarter turn ahead; `null` where it is not determined.
    pub matrix: Option<[[f64; 2]; 2]>,
    /// Standard errors of the entries of `matrix`; `null` where `matrix` is `null`.
    pub standard_errors: Option<[[f64; 2]; 2]>,
}
