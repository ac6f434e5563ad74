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
    /// Files that were read.
    pub inputs: Vec<InputFile>,
    /// Wall time in seconds.
    #[schemars(range(min = 0.0))]
    pub wall_seconds: f64,
    /// Warnings that the reader should know before using the numbers.
    pub warnings: Vec<String>,
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct InputFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 checksum of the content, hexadecimal.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub sha256: String,
}

/// Everything `infer` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InferReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Verdict of the fit, as one word and as a sentence.
    pub verdict: Verdict,
    /// Units of the data. The `unit` of a number is a product of powers of these, such as `µm⁻² min⁻¹`.
    pub units: Units,
    /// Cell size ℓ₀; ℓ₀² is the mean area of the cells used.
    pub length_scale: Quantity,
    /// Unit of time of the coefficients in `identifiability`, whose unit of length is ℓ₀.
    pub time_scale: Quantity,
    /// Which frames and cells were used.
    pub cells: CellCounts,
    /// How the cells were measured.
    pub measurement: Measurement,
    /// Grid of the flow field; `null` for velocities of cells.
    pub flow: Option<FlowGrid>,
    /// Constraints on the parameters that were given before the fit.
    pub constraints: GivenConstraints,
    /// Nudged estimate of the parameters, in units of the data.
    pub parameters: Parameters,
    /// Polarity of the cells, with `--active`; `null` otherwise.
    pub activity: Option<ActivityReport>,
    /// How much cells differ, one entry for each parameter of `--vary`; empty without it.
    pub spreads: Vec<SpreadReport>,
    /// Results for the cells of each label, with `--by-label`, the reference label first; empty without it.
    pub by_label: Vec<KindReport>,
    /// Moduli over the friction γ of a cell, and phase diffusivities, that the parameters imply in mean-field theory; `null` if K_P is not positive, where the
    /// theory does not apply.
    pub implied_moduli: Option<ImpliedByMeanField>,
    /// The same parameters from least squares at the measured positions, without nudges.
    pub naive: NaiveParameters,
    /// Normalised mean square errors Σ‖v − v̂‖²/Σ‖v‖² of the velocities or, if tracks were fitted, of the mean velocities between frames.
    pub nmse: Nmse,
    /// Measurement noise: standard deviations of one component.
    pub noise: Noise,
    /// The nudges: fitted displacements of the measured positions.
    pub nudge: Nudge,
    /// Principal axes of the covariance of (K_A, K_P P₀/3.722, K_P, K_P α), in units of ℓ₀ and the time scale, best determined first.
    pub identifiability: Vec<EigenDirection>,
    /// What would be known from more, or better, measurements; `null` where it is not computed.
    pub prospects: Option<ProspectsReport>,
    /// Profile likelihoods, with `--profile`; empty without it.
    pub profiles: Vec<ProfileResult>,
    /// Slices of the likelihood over two parameters, with `--landscape`; empty without it.
    pub landscapes: Vec<LandscapeResult>,
    /// The parametric bootstrap, with `--bootstrap`; `null` otherwise.
    pub bootstrap: Option<BootstrapResult>,
    /// How the fit proceeded and ended.
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

/// Which frames and cells were used.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CellCounts {
    /// Indices of the frames used, zero-based.
    pub frames: Vec<usize>,
    /// Number of cells (or grid points) used, over all frames.
    pub used: usize,
    /// Number of cells (or grid points) left out, over all frames, by reason: `outside_field_of_view`, `polygon_not_closed`, `polygon_uncertain` (a cell that
    /// was not seen could change it), `polygon_too_large` (a hole), `next_to_uncertain`, `no_velocity`; for grid points `missing` and `window_not_filled`.
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
    /// The kind of average over cells that a grid point represents.
    pub window: FlowWindow,
    /// Side of a square window, or standard deviation of a Gaussian one, in units of length.
    pub width: f64,
}

/// The kind of average over cells that a grid point represents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FlowWindow {
    /// Over the square around the grid point.
    Square,
    /// Over the centres of the cells, with Gaussian weights.
    Gaussian,
    /// Over the plane, with Gaussian weights.
    GaussianArea,
}

/// A parameter with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Parameter {
    /// Value.
    pub value: f64,
    /// 95 % interval; `null` for a parameter held fixed. An end that is `null` is not bounded by the data.
    pub ci95: Option<[f64; 2]>,
    /// Whether the parameter was held fixed.
    pub fixed: bool,
    /// Unit; empty if dimensionless.
    pub unit: String,
    /// How well the parameter is known, in a sentence.
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
    /// Area elasticity K_A.
    pub K_A: Parameter,
    /// Perimeter elasticity K_P.
    pub K_P: Parameter,
    /// Preferred perimeter P_0.
    pub P_0: Parameter,
    /// Preferred area, set to ℓ₀². It is never fitted, since no velocity depends on it.
    pub A_0: Parameter,
    /// Chirality α.
    pub alpha: Parameter,
    /// Chirality as a rate, K_P α.
    pub K_P_alpha: Parameter,
    /// Preferred shape index P_0/ℓ₀.
    pub shape_index: Parameter,
}

/// Estimate without nudges, in units of the data; a value that was not determined is not finite (`null`).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct NaiveParameters {
    /// Area elasticity K_A, in 1/(length² time).
    pub K_A: f64,
    /// Perimeter elasticity K_P, in 1/time.
    pub K_P: f64,
    /// Preferred perimeter P_0, in units of length.
    pub P_0: f64,
    /// Chirality α.
    pub alpha: f64,
    /// Chirality as a rate, K_P α, in 1/time.
    pub K_P_alpha: f64,
    /// Preferred shape index P_0/ℓ₀.
    pub shape_index: f64,
}

/// Normalised mean square errors Σ‖v − v̂‖²/Σ‖v‖² over the cells used.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Nmse {
    /// Error of the naive parameters at the measured positions.
    pub naive: f64,
    /// Error of the nudged parameters at the nudged positions (the fit's own data).
    pub nudged: f64,
    /// Error of the nudged parameters at the measured positions.
    pub un_nudged: f64,
    /// What `un_nudged` and the held-out error would be from measurement noise alone, if the model and the noise levels are right; for tracks, the error of the
    /// mean velocities that is due to position errors. `null` if a noise level was estimated from the same fit.
    pub noise_floor: f64,
    /// Error on cells predicted from a fit that did not see their velocities; `null` with too few cells.
    pub cross_validated: Option<f64>,
    /// Standard error of `cross_validated` over its folds; `null` with too few cells.
    pub cross_validated_standard_error: Option<f64>,
    /// Which mean velocity was subtracted from the data.
    pub mean_removed: MeanRemoved,
    /// Degree of the background, polynomials of the position that the model need not explain; `null` without a background. Velocities and residuals are then
    /// those without it.
    pub background: Option<u32>,
}

/// Which mean velocity was subtracted before the fit.
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

/// Measurement noise: standard deviations of one component.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Noise {
    /// Standard deviation of a component of the positions, in units of length.
    pub sigma_r: f64,
    /// Standard deviation of a component of the velocities, in units of length per time.
    pub sigma_v: f64,
    /// Where the noise levels come from.
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
    /// At least one of the two was estimated from these data.
    Estimated,
    /// Assumed, because nothing better was known.
    Assumed,
}

/// The nudges as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Nudge {
    /// Spring constant σ_v²/σ_r², in 1/time².
    pub k: f64,
    /// Root mean square length of a nudge, in units of length.
    pub rms: f64,
    /// Effective number of parameters that the nudges use, df.
    pub degrees_of_freedom: f64,
    /// Contribution of the nudges to the objective divided by that of the velocities.
    pub contribution_ratio: f64,
    /// Expected value of that ratio if the noise levels are right: df/(2·used − df − p) with p free coefficients.
    pub expected_contribution_ratio: f64,
    /// Number of contacts between neighbours that the nudges changed (lost plus gained).
    pub edges_changed: usize,
}

/// How a fit proceeded and ended.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Fit {
    /// How the objective was minimised.
    pub method: FitMethod,
    /// How the fit ended.
    pub status: FitStatus,
    /// Whether there is no reason to doubt the fit (`doubts` is empty).
    pub trustworthy: bool,
    /// What is in doubt: one name for each entry of `doubts`.
    #[schemars(extend("items" = {"type": "string", "enum": ["objective", "position_noise", "optimiser", "profile", "cells", "outliers", "pattern", "tracks", "positions", "window"]}))]
    pub doubtful: Vec<String>,
    /// Reasons not to trust the fit, and what to do.
    pub doubts: Vec<String>,
    /// Number of iterations.
    pub iterations: usize,
    /// Number of velocities (for tracks: motions) that count less than half, because nothing explains them.
    pub downweighted: usize,
    /// Penalised objective at the end of the fit, in units of the noise variance.
    pub objective: f64,
    /// Objective that a good fit is expected to reach: number of data minus number of parameters.
    pub expected_objective: f64,
    /// Objective after each iteration of the last fit, with the spring constant in force at that iteration.
    pub trace: Vec<f64>,
    /// Objective at the end of each start of the search.
    pub starts: Vec<f64>,
    /// Flips of contacts between neighbours during the search.
    pub transitions: Transitions,
}

/// How the objective was minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FitMethod {
    /// Levenberg–Marquardt by continuation, with flips of contacts and further starts.
    Search,
    /// First-order descent.
    Descent,
}

/// Flips of contacts between neighbours during the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Transitions {
    /// Number of flips tried.
    pub tried: usize,
    /// Number of flips kept.
    pub made: usize,
}

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FitStatus {
    /// It reached a minimum.
    Converged,
    /// It reached the limit of iterations while still descending.
    IterationLimit,
    /// It found no further descent although it is not at a minimum.
    Stalled,
}
