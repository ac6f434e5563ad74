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
    /// Width of the channel, along x, in units of length.
    pub width: f64,
    /// Length of the channel, along y, in units of length.
    pub length: f64,
    /// `x` if there are torque-free walls at both edges; `null` in a periodic box.
    #[schemars(extend("enum" = ["x", null]))]
    pub walls: Option<&'static str>,
    /// Cell size ℓ₀ at the beginning of the run, in units of length.
    pub cell_size: f64,
    /// Parameters of the model, in the units above.
    pub parameters: ModelParameters,
    /// Extrusion and proliferation of cells.
    pub turnover: TurnoverRecord,
    /// Time before the averages, in units of time.
    pub relaxation: f64,
    /// Averaging time requested, in units of time.
    pub time: f64,
    /// Largest time step, in units of time.
    pub dt: f64,
    /// Number of samples that were averaged, each over an equal part of the averaging time.
    pub samples: usize,
    /// Number of strips across the channel.
    pub bins: usize,
    /// Number of time steps made.
    pub steps: usize,
    /// Numbers of cells, births and extrusions.
    pub cells: CellNumbers,
    /// Why the run ended early; `null` if it did not.
    pub ended: Option<String>,
    /// Exponential decays of the folded profiles, by name of the profile; profiles to which no decay could be fitted are left out.
    #[schemars(extend("propertyNames" = {"enum": ["density", "velocity_x", "velocity_y"]}))]
    pub decays: BTreeMap<&'static str, DecayRecord>,
    /// Check of the conservation of cells.
    pub conservation: ConservationRecord,
    /// Balance of forces along the channel.
    pub momentum: MomentumRecord,
    /// Continuum theory with the moduli of the honeycomb; `null` where it has no steady state.
    pub continuum: Option<ContinuumRecord>,
    /// Continuum theory with a measured equation of state; `null` if none was given.
    pub liquid: Option<LiquidRecord>,
    /// Chirality implied by the slope of v_y against v_x; `null` if the velocities do not determine a slope.
    pub chirality_from_flow: Option<SlopeRecord>,
    /// Immediate change of the velocities by a birth at the end of the run, for each kind of injection, in units of velocity; `null` if a new cell would lie on
    /// another one.
    pub birth_disturbance: Option<DisturbanceRecord>,
}

/// Extrusion and birth of cells.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TurnoverRecord {
    /// Rate of extrusion k₀ at the edge, in 1/time.
    pub extrusion_rate: f64,
    /// Decay length d_extr of the extrusion rate, in units of length; `null` if the rate is the same everywhere.
    pub extrusion_length: f64,
    /// Whether births replace extrusions (`replacing`) or have a rate of their own (`independent`).
    #[schemars(extend("enum" = ["replacing", "independent"]))]
    pub proliferation: &'static str,
    /// Rate of proliferation k₁ at the edge, in 1/time; `null` if births replace extrusions.
    pub proliferation_rate: Option<f64>,
    /// Decay length d_prolif of proliferation, in units of length.
    pub proliferation_length: f64,
    /// Where new cells appear: on a vertex (`vertex`), beside a mother (`division`), or by a growing cell dividing in two (`cycle`).
    #[schemars(extend("enum" = ["vertex", "division", "cycle"]))]
    pub injection: &'static str,
    /// Distance between daughter and mother (`division`), or between the two daughters if it was given (`cycle`), in units of length; `null` otherwise.
    pub division_distance: Option<f64>,
    /// Growth and division of cells; `null` without cell cycles.
    pub cycle: Option<CycleRecord>,
}

/// Cell cycles of growth and division.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct CycleRecord {
    /// Coefficient of variation of the cycle lengths, as requested.
    pub variation: f64,
    /// Preferred area of a cell at division, relative to that of the model.
    pub size_at_division: f64,
    /// Line on which the daughters lie: the long axis of the mother (`long`) or a random direction (`random`).
    #[schemars(extend("enum" = ["long", "random"]))]
    pub axis: &'static str,
    /// Preferred area relative to that of the model, averaged over cells and time.
    pub mean_size: f64,
    /// Number of complete cycles, from birth to division, in the run.
    pub cycles: usize,
    /// Mean duration of these cycles, in units of time.
    pub mean_time: f64,
    /// Standard deviation of these durations, in units of time.
    pub time_deviation: f64,
}

/// Numbers of cells, births and extrusions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CellNumbers {
    /// Number of cells at the beginning.
    pub first: usize,
    /// Number of cells at the end.
    pub last: usize,
    /// Smallest number of cells during the run.
    pub fewest: usize,
    /// Largest number of cells during the run.
    pub most: usize,
    /// Number of births in the whole run.
    pub births: usize,
    /// Number of extrusions in the whole run.
    pub extrusions: usize,
}

/// An exponential decay from the edges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DecayRecord {
    /// Decay length, in units of length.
    pub length: f64,
    /// 95 % interval of `length`; an end that is `null` is not bounded.
    pub length_ci95: [Option<f64>; 2],
    /// Amplitude, extrapolated to the edge, in the unit of the profile.
    pub amplitude: f64,
    /// Standard error of `amplitude`.
    pub amplitude_error: f64,
    /// Constant background, in the unit of the profile.
    pub background: f64,
    /// χ² per degree of freedom.
    pub reduced_chi_square: f64,
    /// Distance from the edge at which the fit begins, in units of length.
    pub from: f64,
}

/// ∂_x(ρ v_x)/ρ compared with k_prolif − k_extr.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ConservationRecord {
    /// Number of faces between strips, from the edge to the middle, at which the two are compared.
    pub faces: usize,
    /// Largest magnitude of the difference between the two, in 1/time.
    pub largest_difference: f64,
    /// Largest magnitude of the difference in units of its standard error.
    pub largest_in_errors: f64,
    /// Largest magnitude of k_prolif − k_extr, in 1/time.
    pub largest_rate: f64,
}

/// What drives the transport of cells along the channel between a distance from the edge and the middle. Each value is followed by its standard error, which is
/// `null` where it is not known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct MomentumRecord {
    /// Distance from the edge, in units of length: the first face between strips at or beyond the start of the decay fits.
    pub distance: f64,
    /// ∫ ρ v_y dx from `distance` to the middle, and its standard error.
    pub transport: (f64, Option<f64>),
    /// σ_yx in the middle minus σ_yx at `distance`, and its standard error; in the steady state it equals `transport`.
    pub shear_stress: (f64, Option<f64>),
    /// ½ (τ at `distance` − τ in the middle), and its standard error: the part of the stress difference that is due to the torques of the cells.
    pub torque: (f64, Option<f64>),
}

/// Continuum theory compared with the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ContinuumRecord {
    /// (B + μ)/ρ_0, in length²/time.
    pub longitudinal: f64,
    /// (A − Kᵒ)/ρ_0, in length²/time.
    pub transverse: f64,
    /// Ratio v_y/v_x in the theory.
    pub ratio: f64,
    /// Root mean square difference of v_x between theory and simulation, in units of the largest v_x of the theory.
    pub velocity_x_difference: f64,
    /// The same for v_y, in units of the largest v_y of the simulation.
    pub velocity_y_difference: f64,
}

/// Theory of a liquid with a measured equation of state, compared with the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LiquidRecord {
    /// Lowest and highest density of the equation of state, in cells per area.
    pub density_range: [f64; 2],
    /// Number of strips whose simulated density is outside this range.
    pub places_beyond: usize,
    /// Root mean square difference of the density between theory and simulation, in units of the largest deviation from the mean density in the theory.
    pub density_difference: f64,
    /// Root mean square difference of v_x between theory and simulation, in units of the largest v_x of the theory.
    pub velocity_x_difference: f64,
    /// The same for v_y, in units of the largest v_y of the simulation.
    pub velocity_y_difference: f64,
    /// ∫ ρ v_y dx from `momentum.distance` to the middle, as implied by the simulated density: ½ (τ(ρ) − τ(ρ in the middle)).
    pub transport: f64,
}

/// A straight line through the points (v_x, v_y), and the chirality that it implies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SlopeRecord {
    /// Number of points fitted.
    pub points: usize,
    /// Distances from the edge between which points were used (from, to), in units of length; an end that was not given is `null`.
    pub range: [Option<f64>; 2],
    /// Slope v_y/v_x of the line.
    pub slope: f64,
    /// 95 % interval of `slope`.
    pub slope_ci95: [f64; 2],
    /// Intercept of the line, in units of velocity; zero if it was held there.
    pub intercept: f64,
    /// χ² per degree of freedom; `null` if no errors are known.
    pub reduced_chi_square: Option<f64>,
    /// Preferred perimeter in cell sizes, P₀/ℓ₀; `null` where it is not known.
    pub shape_index: Option<f64>,
    /// Chirality implied by the slope, α = slope (3 − a P₀/ℓ₀) for K_A = 0; `null` where P₀/ℓ₀ is not known, and between walls.
    pub alpha: Option<f64>,
    /// 95 % interval of `alpha` due to that of the slope alone; `null` where `alpha` is `null`.
    pub alpha_ci95: Option<[f64; 2]>,
    /// Chirality by the rule of thumb α = slope/0.5.
    pub alpha_rule_of_thumb: f64,
    /// Smallest and largest α that the slope implies for 3 < P₀/ℓ₀ < 5.
    pub alpha_range: [f64; 2],
}

/// Largest immediate change of a velocity at a birth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DisturbanceRecord {
    /// Number of births tried, at random places.
    pub draws: usize,
    /// Distance between daughter and mother, in units of length.
    pub division_distance: f64,
    /// Mean over births on vertices, in units of velocity.
    pub vertex_mean: f64,
    /// Mean over births beside a mother, in units of velocity.
    pub division_mean: f64,
    /// Mean over divisions in two, in units of velocity; `null` without cell cycles.
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
    /// Whether the line was held at the origin (`zero`) or its intercept was fitted (`free`).
    #[schemars(extend("enum" = ["zero", "free"]))]
    pub intercept_kind: &'static str,
}
