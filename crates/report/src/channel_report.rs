//! `report.json` of the commands `channel` and `estimate-chirality`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not
//! finite are written as `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::ModelParameters;
use crate::infer_report::RunRecord;
use crate::units::Units;

/// Everything `channel` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ChannelReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Width, across x, in units of length.
    pub width: f64,
    /// Length, along y, in units of length.
    pub length: f64,
    /// `x` with torque-free walls at both edges; `null` in a periodic box.
    #[schemars(extend("enum" = ["x", null]))]
    pub walls: Option<&'static str>,
    /// The cell size ℓ₀ at the beginning.
    pub cell_size: f64,
    /// Parameters of the model, by the names of the interface, in the units above.
    pub parameters: ModelParameters,
    /// Extrusion and proliferation.
    pub turnover: TurnoverRecord,
    /// Time before the averages.
    pub relaxation: f64,
    /// Time of the averages asked for.
    pub time: f64,
    /// Largest time step.
    pub dt: f64,
    /// Samples averaged, equal pieces of the time.
    pub samples: usize,
    /// Strips across the channel.
    pub bins: usize,
    /// Steps made.
    pub steps: usize,
    /// How many cells there were.
    pub cells: CellNumbers,
    /// Why the run ended before its time; `null` if it did not.
    pub ended: Option<String>,
    /// Exponential decays of the folded profiles, for each profile that one fits.
    #[schemars(extend("propertyNames" = {"enum": ["density", "velocity_x", "velocity_y"]}))]
    pub decays: BTreeMap<&'static str, DecayRecord>,
    /// Conservation of cells.
    pub conservation: ConservationRecord,
    /// Balance of forces along the channel.
    pub momentum: MomentumRecord,
    /// The continuum theory with the moduli of the honeycomb; `null` where it has no steady state.
    pub continuum: Option<ContinuumRecord>,
    /// The continuum theory with a measured equation of state; `null` if none was given.
    pub liquid: Option<LiquidRecord>,
    /// The chirality that the slope of v_y against v_x implies; `null` if the velocities tell no slope.
    pub chirality_from_flow: Option<SlopeRecord>,
    /// How much a birth changes velocities at once, by either way of injection, at the end of the run, in units of velocity.
    pub birth_disturbance: Option<DisturbanceRecord>,
}

/// How cells are extruded and born.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TurnoverRecord {
    /// Rate of extrusion at the edge k₀, in 1/time.
    pub extrusion_rate: f64,
    /// Its decay length d_extr; `null` if it is the same everywhere.
    pub extrusion_length: f64,
    /// Whether births replace extrusions, or have a rate of their own.
    #[schemars(extend("enum" = ["replacing", "independent"]))]
    pub proliferation: &'static str,
    /// Rate of proliferation at the edge k₁, in 1/time; `null` if births replace extrusions.
    pub proliferation_rate: Option<f64>,
    /// Its decay length d_prolif.
    pub proliferation_length: f64,
    /// Where new cells appear.
    #[schemars(extend("enum" = ["vertex", "division", "cycle"]))]
    pub injection: &'static str,
    /// Distance of a daughter from her mother, if cells divide, or of two daughters, if it was given; `null` otherwise.
    pub division_distance: Option<f64>,
    /// Growth and division; `null` if cells have no cycles.
    pub cycle: Option<CycleRecord>,
}

/// Cycles of growth and division.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct CycleRecord {
    /// Coefficient of variation of their lengths that was asked for.
    pub variation: f64,
    /// Preferred area at division over that of the model.
    pub size_at_division: f64,
    /// The line on which daughters lie: the long axis of the mother, or any.
    #[schemars(extend("enum" = ["long", "random"]))]
    pub axis: &'static str,
    /// Preferred area over that of the model, mean over cells and time.
    pub mean_size: f64,
    /// Cycles from birth to division in the run.
    pub cycles: usize,
    /// How long they took in the mean.
    pub mean_time: f64,
    /// Their standard deviation.
    pub time_deviation: f64,
}

/// Numbers of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CellNumbers {
    /// At the beginning.
    pub first: usize,
    /// At the end.
    pub last: usize,
    /// Fewest on the way.
    pub fewest: usize,
    /// Most on the way.
    pub most: usize,
    /// Births in the whole run.
    pub births: usize,
    /// Extrusions in the whole run.
    pub extrusions: usize,
}

/// A decay from the edges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DecayRecord {
    /// Decay length.
    pub length: f64,
    /// Its 95 % interval; an end that is `null` is not bounded.
    pub length_ci95: [Option<f64>; 2],
    /// Amplitude, extrapolated to the edge.
    pub amplitude: f64,
    /// Its standard error.
    pub amplitude_error: f64,
    /// Background.
    pub background: f64,
    /// χ² per degree of freedom.
    pub reduced_chi_square: f64,
    /// Distance from the edge at which the fit begins.
    pub from: f64,
}

/// ∂_x(ρ v_x)/ρ against k_prolif − k_extr.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ConservationRecord {
    /// Places between bins, from the edge to the middle.
    pub faces: usize,
    /// Largest difference of the two, in 1/time.
    pub largest_difference: f64,
    /// Largest difference in its standard errors.
    pub largest_in_errors: f64,
    /// Largest size of k_prolif − k_extr, in 1/time.
    pub largest_rate: f64,
}

/// What carries cells along the channel between a distance from the edge and the middle, each with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct MomentumRecord {
    /// Distance from the edge, next to where the decays are fitted from.
    pub distance: f64,
    /// ∫ ρ v_y dx from there to the middle, with its standard error.
    pub transport: (f64, Option<f64>),
    /// σ_yx at the middle less σ_yx there, with its standard error: equal to `transport` in the steady state.
    pub shear_stress: (f64, Option<f64>),
    /// ½ (τ − τ at the middle), with its standard error: the part of the stress that is due to torques of the cells.
    pub torque: (f64, Option<f64>),
}

/// The theory beside the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ContinuumRecord {
    /// B + μ, in 1/time.
    pub longitudinal: f64,
    /// A − Kᵒ, in 1/time.
    pub transverse: f64,
    /// v_y/v_x.
    pub ratio: f64,
    /// Root mean square difference of v_x, in units of its largest value in the theory.
    pub velocity_x_difference: f64,
    /// The same of v_y, in units of the largest v_y of the simulation.
    pub velocity_y_difference: f64,
}

/// The theory of a liquid with an equation of state beside the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LiquidRecord {
    /// Lowest and highest density of the equation of state, cells per area.
    pub density_range: [f64; 2],
    /// Strips whose simulated density is beyond them.
    pub places_beyond: usize,
    /// Root mean square difference of the density, in units of the largest deviation from its mean in the theory.
    pub density_difference: f64,
    /// Root mean square difference of v_x, in units of its largest value in the theory.
    pub velocity_x_difference: f64,
    /// The same of v_y, in units of the largest v_y of the simulation.
    pub velocity_y_difference: f64,
    /// ∫ ρ v_y dx from `momentum.distance` to the middle that the simulated density implies: ½ (τ(ρ) − τ(ρ in the middle)).
    pub transport: f64,
}

/// A line through the points (v_x, v_y).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SlopeRecord {
    /// Points.
    pub points: usize,
    /// Distances from the edge that counted: from, to; an end that was not given is `null`.
    pub range: [Option<f64>; 2],
    /// Slope v_y/v_x.
    pub slope: f64,
    /// Its 95 % interval.
    pub slope_ci95: [f64; 2],
    /// Intercept of the line; zero if it was held there.
    pub intercept: f64,
    /// χ² per degree of freedom; `null` if no errors are known.
    pub reduced_chi_square: Option<f64>,
    /// Preferred perimeter in cell sizes P₀/ℓ₀; `null` where it is not known.
    pub shape_index: Option<f64>,
    /// α = slope (3 − a P₀/ℓ₀); `null` where P₀/ℓ₀ is not known and between walls.
    pub alpha: Option<f64>,
    /// Its 95 % interval, the slope's alone; `null` where `alpha` is.
    pub alpha_ci95: Option<[f64; 2]>,
    /// The rule of thumb α = slope/0.5.
    pub alpha_rule_of_thumb: f64,
    /// What 3 < P₀/ℓ₀ < 5 leaves open: the least and the largest α of the slope.
    pub alpha_range: [f64; 2],
}

/// Largest change of a velocity at a birth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DisturbanceRecord {
    /// Births tried, at random places.
    pub draws: usize,
    /// Distance of a daughter from her mother.
    pub division_distance: f64,
    /// Mean over births on vertices.
    pub vertex_mean: f64,
    /// Mean over births beside a mother.
    pub division_mean: f64,
    /// Mean over divisions in two; `null` if cells have no cycles.
    pub cycle_mean: Option<f64>,
}

/// Everything `estimate-chirality` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ChiralityReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// The line and what it implies.
    #[serde(flatten)]
    pub line: SlopeRecord,
    /// Whether the line was held at the origin.
    #[schemars(extend("enum" = ["zero", "free"]))]
    pub intercept_kind: &'static str,
}
