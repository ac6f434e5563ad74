//! `report.json` of the command `infer`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that
//! are not finite are written as `null`.

mod activity;
mod constraints;
mod implied;
mod kinds;
mod latent;
mod measured;
mod measurement;
mod prospects;
mod spreads;
mod tracks;
mod uncertainty;
mod verdict;

pub use activity::ActivityReport;
pub use constraints::{GivenConstraints, GivenPrior};
pub use implied::ImpliedByMeanField;
pub use kinds::{KindDifference, KindReport};
pub use latent::LatentCells;
pub use measured::{MeasuredPositions, MeasuredWindow, MeasurementSource, PositionKind, TriedWindow};
pub use measurement::{Measurement, RegionSource, SeenRegion};
pub use prospects::{AmbiguityReport, DESIGNS, ProspectOf, ProspectsReport};
pub use spreads::SpreadReport;
pub use tracks::TracksReport;
pub use uncertainty::{BootstrapResult, EigenDirection, LandscapeResult, ProfileResult};
pub use verdict::{Verdict, VerdictKind};

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::units::Units;

/// What every command reports about its run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RunRecord {
    /// Name of the command, for example `infer`.
    pub command: String,
    /// The command line as typed.
    pub command_line: String,
    /// Version of the program.
    pub version: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of threads.
    #[schemars(range(min = 1))]
    pub threads: usize,
    /// Files read.
    pub inputs: Vec<InputFile>,
    /// Wall time in seconds.
    #[schemars(range(min = 0.0))]
    pub wall_seconds: f64,
    /// What the reader should know before using the numbers.
    pub warnings: Vec<String>,
}

/// One file read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct InputFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 of the content, hexadecimal.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub sha256: String,
}

/// Everything `infer` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InferReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// What the fit says, in a word and in a sentence.
    pub verdict: Verdict,
    /// Units of the data. The `unit` of a number is a product of powers of these, such as `µm⁻² min⁻¹`.
    pub units: Units,
    /// The cell size ℓ₀, ℓ₀² = mean area of the cells used.
    pub length_scale: Quantity,
    /// The time that coefficients of `identifiability` are counted in, with ℓ₀ as the length.
    pub time_scale: Quantity,
    /// Which cells were used.
    pub cells: CellCounts,
    /// How the cells were measured.
    pub measurement: Measurement,
    /// The grid of a flow field; `null` for velocities of cells.
    pub flow: Option<FlowGrid>,
    /// What was said of the parameters before the fit.
    pub constraints: GivenConstraints,
    /// The nudged estimate, in the units of the data.
    pub parameters: Parameters,
    /// Polarity of the cells, with `--active`; `null` otherwise.
    pub activity: Option<ActivityReport>,
    /// How much cells differ, one for each parameter of `--vary`; empty without.
    pub spreads: Vec<SpreadReport>,
    /// The cells of each label, with `--by-label`, first those that others are compared with; empty without.
    pub by_label: Vec<KindReport>,
    /// Moduli over the friction γ of a cell, and phase diffusivities, that the parameters imply by the mean-field theory; `null` where it has none: if K_P is not positive.
    pub implied_moduli: Option<ImpliedByMeanField>,
    /// The same parameters by least squares at the measured positions.
    pub naive: NaiveParameters,
    /// Normalised errors Σ‖v − v̂‖²/Σ‖v‖² of velocities, or of mean velocities between frames where tracks were fitted.
    pub nmse: Nmse,
    /// Measurement noise per component.
    pub noise: Noise,
    /// The nudges.
    pub nudge: Nudge,
    /// Principal axes of the covariance of (K_A, K_P P₀/3.722, K_P, K_P α), in units of ℓ₀ and the time scale, best determined first.
    pub identifiability: Vec<EigenDirection>,
    /// What would be known if more, or better, had been measured; `null` where that is not computed.
    pub prospects: Option<ProspectsReport>,
    /// Profile likelihoods, with `--profile`; empty without.
    pub profiles: Vec<ProfileResult>,
    /// Slices of the landscape, with `--landscape`; empty without.
    pub landscapes: Vec<LandscapeResult>,
    /// The parametric bootstrap, with `--bootstrap`; `null` otherwise.
    pub bootstrap: Option<BootstrapResult>,
    /// Course of the fit.
    pub fit: Fit,
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Quantity {
    /// The number.
    pub value: f64,
    /// Its unit; empty if dimensionless.
    pub unit: String,
}

/// Which cells took part.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CellCounts {
    /// Indices of the frames used, zero-based.
    pub frames: Vec<usize>,
    /// Cells (or grid points) used, over all frames.
    pub used: usize,
    /// Cells (or grid points) left out, over all frames, by reason: `outside_field_of_view`, `polygon_not_closed`, `polygon_uncertain` (a cell that was not seen could change it), `polygon_too_large` (a hole), `next_to_uncertain`, `no_velocity`; of grid points `missing`, `window_not_filled`.
    pub left_out: BTreeMap<String, usize>,
}

/// The grid on which velocities were measured.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FlowGrid {
    /// Number of grid points along x and y.
    #[schemars(inner(range(min = 1)))]
    pub grid_points: [usize; 2],
    /// Distance between grid points along x and y, in units of length.
    pub spacing: [f64; 2],
    /// The average over cells that a grid point stands for.
    pub window: FlowWindow,
    /// Side of a square window, standard deviation of a Gaussian one, in units of length.
    pub width: f64,
}

/// The average over cells that a grid point stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FlowWindow {
    /// Over the square around it.
    Square,
    /// Over the centres of the cells, with Gaussian weights.
    Gaussian,
    /// Over the plane, with Gaussian weights.
    GaussianArea,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Parameter {
    /// Value.
    pub value: f64,
    /// 95 % interval; `null` for a parameter held fixed. An end that is `null` is not bounded by the data.
    pub ci95: Option<[f64; 2]>,
    /// Whether it was held fixed.
    pub fixed: bool,
    /// Unit; empty if dimensionless.
    pub unit: String,
    /// How well it is known, in a sentence.
    pub words: String,
}

impl Parameter {
    /// The 95 % interval with `None` for an end that is not bounded; none for a parameter held
    /// fixed and where an end is not known.
    #[must_use]
    pub fn interval(&self) -> Option<[Option<f64>; 2]> {
        let [low, high] = self.ci95?;
        let is_known = low < f64::INFINITY && high > f64::NEG_INFINITY;
        is_known.then(|| [low, high].map(|end| Some(end).filter(|end| end.is_finite())))
    }
}

/// The parameters of the model and two combinations of them.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct Parameters {
    /// Area elasticity.
    pub K_A: Parameter,
    /// Perimeter elasticity.
    pub K_P: Parameter,
    /// Preferred perimeter.
    pub P_0: Parameter,
    /// Preferred area: ℓ₀², and never fitted, since no velocity depends on it.
    pub A_0: Parameter,
    /// Chirality.
    pub alpha: Parameter,
    /// Chirality in units of a rate.
    pub K_P_alpha: Parameter,
    /// P_0/ℓ₀.
    pub shape_index: Parameter,
}

/// The estimate without nudges; not finite (`null`) where it was not determined.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct NaiveParameters {
    /// Area elasticity.
    pub K_A: f64,
    /// Perimeter elasticity.
    pub K_P: f64,
    /// Preferred perimeter.
    pub P_0: f64,
    /// Chirality.
    pub alpha: f64,
    /// Chirality in units of a rate.
    pub K_P_alpha: f64,
    /// P_0/ℓ₀.
    pub shape_index: f64,
}

/// Normalised mean square errors Σ‖v − v̂‖²/Σ‖v‖² over the cells used.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Nmse {
    /// Naive parameters at the measured positions.
    pub naive: f64,
    /// Nudged parameters at the nudged positions (the fit's own data).
    pub nudged: f64,
    /// Nudged parameters at the measured positions.
    pub un_nudged: f64,
    /// What measurement noise alone makes of `un_nudged` and of the held-out error if the model and the noise levels are right; of tracks, what errors of positions make of the mean velocities; `null` if a noise level was estimated from the same fit.
    pub noise_floor: f64,
    /// Cells predicted from a fit that did not see their velocities; `null` with too few cells.
    pub cross_validated: Option<f64>,
    /// Standard error of `cross_validated` over its folds; `null` likewise.
    pub cross_validated_standard_error: Option<f64>,
    /// Which mean velocity was removed from the data.
    pub mean_removed: MeanRemoved,
    /// Degree of the polynomials of the position that are no concern of the model; `null` if no background is allowed. Velocities
    /// and residuals are then those without it.
    pub background: Option<u32>,
}

/// Which mean velocity was removed before the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeanRemoved {
    /// None.
    None,
    /// The median over the used cells of each frame, component by component.
    PerFrame,
    /// The median over the used cells of all frames.
    Overall,
}

/// Measurement noise per component.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Noise {
    /// Standard deviation of the positions, in units of length.
    pub sigma_r: f64,
    /// Standard deviation of the velocities, in units of length per time.
    pub sigma_v: f64,
    /// Where the levels come from.
    pub source: NoiseSource,
}

/// Where the noise levels come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// Given on the command line.
    Given,
    /// Stated by the data set.
    DataSet,
    /// Estimated from these data, at least one of the two.
    Estimated,
    /// Assumed for want of anything better.
    Assumed,
}

/// The nudges as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Nudge {
    /// Spring constant σ_v²/σ_r², in units of a rate squared.
    pub k: f64,
    /// Root mean square of the length of a nudge, in units of length.
    pub rms: f64,
    /// Effective number of parameters that the nudges use up, df.
    pub degrees_of_freedom: f64,
    /// What nudges contribute to the objective per contribution of velocities.
    pub contribution_ratio: f64,
    /// What that ratio is expected to be if the noise levels are right: df/(2·used − df − p) with p free coefficients.
    pub expected_contribution_ratio: f64,
    /// Contacts between neighbours that the nudges changed (lost plus gained).
    pub edges_changed: usize,
}

/// Course of the fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Fit {
    /// How the objective was made small.
    pub method: FitMethod,
    /// How it ended.
    pub status: FitStatus,
    /// Whether there is no reason not to trust it.
    pub trustworthy: bool,
    /// What is in doubt, one name for each of `doubts`.
    #[schemars(extend("items" = {"type": "string", "enum": ["objective", "position_noise", "optimiser", "profile", "cells", "outliers", "pattern", "tracks", "positions", "window"]}))]
    pub doubtful: Vec<String>,
    /// Reasons not to trust it, and what to do.
    pub doubts: Vec<String>,
    /// Number of iterations.
    pub iterations: usize,
    /// Velocities, or in tracks motions, that count less than half, because nothing explains them.
    pub downweighted: usize,
    /// Penalised objective at the end, in units of the noise variance.
    pub objective: f64,
    /// The objective that a good fit is expected to reach (data minus parameters).
    pub expected_objective: f64,
    /// Objective after each iteration of the last fit, with the springs in force at that iteration.
    pub trace: Vec<f64>,
    /// Objective at the end of each start.
    pub starts: Vec<f64>,
    /// Flips of contacts between neighbours.
    pub transitions: Transitions,
}

/// How the objective was made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FitMethod {
    /// Levenberg–Marquardt by continuation, flips of contacts, further starts.
    Search,
    /// First-order descent.
    Descent,
}

/// Flips of contacts between neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Transitions {
    /// Those tried.
    pub tried: usize,
    /// Those kept.
    pub made: usize,
}

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FitStatus {
    /// At a minimum.
    Converged,
    /// At the limit of iterations, still descending.
    IterationLimit,
    /// Without a further descent although not at a minimum.
    Stalled,
}
