//! `report.json` of the command `moduli`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are
//! written as `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::ModelParameters;
use crate::infer_report::RunRecord;
use crate::phase_report::CellSpread;
use crate::units::Units;

/// Everything `moduli` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModuliReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units; moduli and stresses are in 1/time.
    pub units: Units,
    /// Number of cells.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Parameters as used, by the names of the interface, in the units above.
    pub parameters: ModelParameters,
    /// By how much cells differ, if they do.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "CellSpread")]
    pub cell_spread: Option<CellSpread>,
    /// How it was measured: amounts and times by the names of the options.
    pub settings: BTreeMap<&'static str, f64>,
    /// `bulk`, `odd_bulk`, `shear`, `odd_shear`, in 1/time.
    pub moduli: Vec<ModulusRecord>,
    /// Mean stress before the strain, in 1/time, force index first.
    pub prestress: [[f64; 2]; 2],
    /// That of the honeycomb; `null` where the theory has none.
    pub mean_field_prestress: Option<[[f64; 2]; 2]>,
    /// `shear_viscosity` and `odd_shear_viscosity`, without a unit; empty if not asked for.
    pub viscosities: Vec<ModulusRecord>,
    /// Storage and loss moduli at each of `--frequencies`; empty if not asked for.
    pub dynamic: Vec<DynamicRecord>,
    /// Media of one elasticity and one viscosity that come nearest to the shear moduli at all frequencies; empty with fewer than two.
    pub media: Vec<MediumRecord>,
    /// Each replica.
    pub replicas: Vec<ReplicaRecord>,
}

/// One modulus or viscosity.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModulusRecord {
    /// Which it is.
    #[schemars(extend("enum" = ["bulk", "odd_bulk", "shear", "odd_shear", "shear_viscosity", "odd_shear_viscosity"]))]
    pub name: &'static str,
    /// Symbol; `_x` sets a subscript.
    pub symbol: &'static str,
    /// Mean over replicas.
    pub value: f64,
    /// Standard error of the mean over replicas; of a single one its own.
    pub error: f64,
    /// Mean without relaxation; `null` for viscosities.
    pub affine: Option<f64>,
    /// What the larger strain gives less what the smaller gives, largest over replicas in magnitude; `null` for viscosities.
    pub nonlinearity: Option<f64>,
    /// The value of the honeycomb in mean-field theory; `null` where there is none.
    pub mean_field: Option<f64>,
    /// The value of each replica.
    pub replicas: Vec<f64>,
    /// The error of each replica.
    pub replica_errors: Vec<f64>,
}

/// Storage and loss moduli at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DynamicRecord {
    /// Angular frequency ω, in 1/time.
    pub frequency: f64,
    /// B, A, μ, Kᵒ, in 1/time; of tissues that flow the shear moduli alone.
    pub moduli: Vec<DynamicModulusRecord>,
}

/// A complex modulus `G′ + i G″` at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DynamicModulusRecord {
    /// Which it is.
    #[schemars(extend("enum" = ["bulk", "odd_bulk", "shear", "odd_shear"]))]
    pub name: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    /// Storage modulus `G′`, in phase with the strain.
    pub storage: Estimate,
    /// Loss modulus `G″`, in phase with the rate of strain.
    pub loss: Estimate,
}

/// A number of one or several replicas.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Estimate {
    /// Mean over replicas.
    pub value: f64,
    /// Standard error of the mean over replicas; of a single one its own.
    pub error: f64,
    /// The value of each replica that has one.
    pub replicas: Vec<f64>,
}

/// A medium of one elasticity and one viscosity.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MediumRecord {
    /// Elasticity and viscosity in parallel (`kelvin_voigt`) or in series (`maxwell`).
    #[schemars(extend("enum" = ["kelvin_voigt", "maxwell"]))]
    pub arrangement: &'static str,
    /// Elasticity: shear modulus μ and odd shear modulus Kᵒ.
    pub elasticity: [f64; 2],
    /// Viscosity: shear viscosity η and odd shear viscosity ηᵒ.
    pub viscosity: [f64; 2],
    /// By how much it misses the moduli: root mean square over frequencies, in parts of the size of each.
    pub missed: f64,
}

/// One replica.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ReplicaRecord {
    /// Seed of its starting positions.
    pub seed: u64,
    /// Whether it came to rest before the strain.
    #[schemars(extend("enum" = ["at_rest", "flowing"]))]
    pub motion: &'static str,
    /// Speed of the fastest cell before the strain.
    pub speed: f64,
    /// Strained states that did not come to rest.
    pub restless: usize,
    /// Mean stress before the strain, force index first.
    pub prestress: [[f64; 2]; 2],
    /// Derivatives of (σ_xx + σ_yy)/2, (σ_yx − σ_xy)/2, (σ_xx − σ_yy)/2, (σ_xy + σ_yx)/2 by ∇·u, e_1, e_2.
    pub response: [[f64; 3]; 4],
}
