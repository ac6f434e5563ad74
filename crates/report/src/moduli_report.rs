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
    /// Parameters of the model as used, in the units above.
    pub parameters: ModelParameters,
    /// How much the cells differ in their parameters; missing if they do not differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "CellSpread")]
    pub cell_spread: Option<CellSpread>,
    /// Settings of the measurement (amounts and times), by name of the option.
    pub settings: BTreeMap<&'static str, f64>,
    /// The moduli `bulk`, `odd_bulk`, `shear` and `odd_shear`, in 1/time.
    pub moduli: Vec<ModulusRecord>,
    /// Stress before the strain, averaged over replicas, in 1/time; force index first.
    pub prestress: [[f64; 2]; 2],
    /// Prestress of the honeycomb in mean-field theory, in 1/time; `null` where the theory has none.
    pub mean_field_prestress: Option<[[f64; 2]; 2]>,
    /// The viscosities `shear_viscosity` and `odd_shear_viscosity`, dimensionless; empty if they were not requested.
    pub viscosities: Vec<ModulusRecord>,
    /// Storage and loss moduli at each of `--frequencies`; empty if they were not requested.
    pub dynamic: Vec<DynamicRecord>,
    /// Media with one elasticity and one viscosity that best fit the shear moduli at all frequencies; empty with fewer than two frequencies.
    pub media: Vec<MediumRecord>,
    /// Results of each replica.
    pub replicas: Vec<ReplicaRecord>,
}

/// One modulus or viscosity.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModulusRecord {
    /// Name of the modulus or viscosity.
    #[schemars(extend("enum" = ["bulk", "odd_bulk", "shear", "odd_shear", "shear_viscosity", "odd_shear_viscosity"]))]
    pub name: &'static str,
    /// Its symbol; `_x` denotes a subscript.
    pub symbol: &'static str,
    /// Mean over replicas.
    pub value: f64,
    /// Standard error of the mean over replicas; for a single replica, its own standard error.
    pub error: f64,
    /// Mean over replicas without relaxation, where displacements follow the strain; `null` for viscosities.
    pub affine: Option<f64>,
    /// Value at the larger strain minus value at the smaller strain, for the replica in which this is largest in magnitude; `null` for viscosities.
    pub nonlinearity: Option<f64>,
    /// Value of the honeycomb in mean-field theory; `null` where there is none.
    pub mean_field: Option<f64>,
    /// Value of each replica.
    pub replicas: Vec<f64>,
    /// Standard error of each replica.
    pub replica_errors: Vec<f64>,
}

/// Storage and loss moduli at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DynamicRecord {
    /// Angular frequency ω, in 1/time.
    pub frequency: f64,
    /// The complex moduli B, A, μ and Kᵒ, in 1/time; for flowing tissues the shear moduli only.
    pub moduli: Vec<DynamicModulusRecord>,
}

/// A complex modulus `G′ + i G″` at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DynamicModulusRecord {
    /// Name of the modulus.
    #[schemars(extend("enum" = ["bulk", "odd_bulk", "shear", "odd_shear"]))]
    pub name: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Storage modulus `G′`, in phase with the strain.
    pub storage: Estimate,
    /// Loss modulus `G″`, in phase with the rate of strain.
    pub loss: Estimate,
}

/// A mean over one or several replicas, with its standard error.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Estimate {
    /// Mean over replicas.
    pub value: f64,
    /// Standard error of the mean over replicas; for a single replica, its own standard error.
    pub error: f64,
    /// Value of each replica that has one.
    pub replicas: Vec<f64>,
}

/// A viscoelastic medium with one elasticity and one viscosity.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MediumRecord {
    /// Elasticity and viscosity in parallel (`kelvin_voigt`) or in series (`maxwell`).
    #[schemars(extend("enum" = ["kelvin_voigt", "maxwell"]))]
    pub arrangement: &'static str,
    /// Elasticity: shear modulus μ and odd shear modulus Kᵒ, in 1/time.
    pub elasticity: [f64; 2],
    /// Viscosity: shear viscosity η and odd shear viscosity ηᵒ, dimensionless.
    pub viscosity: [f64; 2],
    /// Relative deviation of the medium from the moduli: root mean square over frequencies, relative to the magnitude of the moduli at each.
    pub missed: f64,
}

/// Results of one replica.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ReplicaRecord {
    /// Seed of the starting positions.
    pub seed: u64,
    /// Whether the tissue came to rest before the strain (`at_rest`) or not (`flowing`).
    #[schemars(extend("enum" = ["at_rest", "flowing"]))]
    pub motion: &'static str,
    /// Speed of the fastest cell before the strain, in units of velocity.
    pub speed: f64,
    /// Number of strained states that did not come to rest.
    pub restless: usize,
    /// Stress before the strain, in 1/time; force index first.
    pub prestress: [[f64; 2]; 2],
    /// Derivatives of (σ_xx + σ_yy)/2, (σ_yx − σ_xy)/2, (σ_xx − σ_yy)/2 and (σ_xy + σ_yx)/2 (rows) with respect to ∇·u, e_1 and e_2 (columns), in 1/time.
    pub response: [[f64; 3]; 4],
}
