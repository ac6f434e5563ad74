//! `report.json` of `voronudge waves`.

use crate::ModelParameters;
use crate::infer_report::{Quantity, RunRecord};
use crate::units::Units;
use schemars::JsonSchema;
use serde::Serialize;
/// Rows of D(q), in components along the wave vector and a quarter turn ahead.
pub type Rates = [[f64; 2]; 2];

/// Everything `waves` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WavesReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Indices of the frames used, zero-based.
    pub frames: Vec<usize>,
    /// Time between two consecutive frames used.
    pub frame_interval: Quantity,
    /// Number of cells seen in each of these frames.
    pub seen: Vec<usize>,
    /// Cell size: the square root of the mean area of the cells that count.
    pub length_scale: Quantity,
    /// Where the velocities come from: the data (`given`), displacements between frames (`from_positions`), or nowhere (`none`).
    #[schemars(extend("enum" = ["given", "from_positions", "none"]))]
    pub velocities: &'static str,
    /// Whether the median motion of the cells was attributed to the stage and removed.
    pub common_motion_removed: bool,
    /// The field that was resolved into waves.
    #[schemars(extend("enum" = ["displacements", "velocities"]))]
    pub field: &'static str,
    /// Lag τ₀ from which covariances are used, in frames.
    pub first_lag: usize,
    /// Parameters of the model whose D(q) is compared with the measured one, in units of the data; `null` if none are given.
    pub parameters: Option<ModelParameters>,
    /// Probability of differences between D from τ and from 2τ at least as large, if waves relax linearly and without memory, for all reliable shells together;
    /// `null` where it cannot be determined.
    pub linear: Option<f64>,
    /// Conclusion from `linear`: `not_linear` if it is below 0.01, `unknown` if it is `null`, otherwise `linear`.
    #[schemars(extend("enum" = ["linear", "not_linear", "unknown"]))]
    pub verdict: &'static str,
    /// Probability of off-diagonal entries at least as large without chirality, for all reliable shells together; `null` where it cannot be determined.
    pub achiral: Option<f64>,
    /// Standard deviation σ_r of localisation errors that are uncorrelated in time; `null` if velocities were resolved or if it cannot be determined.
    pub localisation: Option<Measured>,
    /// Moduli over friction from waves longer than 2π spacings in a periodic box; `null` where there are none.
    pub long_waves: Option<LongWavesRecord>,
    /// How the dynamic structure factors were computed; `null` where there are none.
    pub spectra: Option<SpectraRecord>,
    /// Results for each shell of wave numbers, in ascending order.
    pub shells: Vec<WaveShellRecord>,
}

/// A number with its standard error.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Measured {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Unit.
    pub unit: String,
}

/// Entries of D over q² for long waves.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct LongWavesRecord {
    /// (B + μ)/ζ.
    pub B_plus_mu: Measured,
    /// μ/ζ.
    pub mu: Measured,
    /// Kᵒ/ζ.
    pub K_o: Measured,
    /// (A − Kᵒ)/ζ.
    pub A_minus_K_o: Measured,
    /// Number of shells over which they are averaged.
    #[schemars(range(min = 1))]
    pub shells: usize,
}

/// How the dynamic structure factors were computed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpectraRecord {
    /// Number of frames in a segment.
    #[schemars(range(min = 2))]
    pub segment: usize,
    /// Number of segments, which overlap by half.
    #[schemars(range(min = 1))]
    pub segments: usize,
    /// Angular frequencies, in 1/time.
    pub frequencies: Vec<f64>,
}

/// Results for one shell of wave numbers.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WaveShellRecord {
    /// Mean wave number, in 1/length.
    pub wave_number: f64,
    /// Number of wave vectors, counting one of each pair ±q.
    #[schemars(range(min = 1))]
    pub wave_vectors: usize,
    /// How the waves relax; `null` where it cannot be determined.
    pub relaxation: Option<RelaxationRecord>,
    /// D(q) from the Jacobian of the model for a wave imposed on all cells alike, in 1/time, rows first; `null` without a model.
    pub jacobian: Option<Rates>,
    /// Inverse of the compliance to waves of forces from the same Jacobian, in 1/time, rows first; `null` without a model and in an open field of view.
    pub jacobian_relaxed: Option<Rates>,
    /// D(q) of the honeycomb in mean-field theory, averaged over directions, in 1/time, rows first; `null` without a model or where the theory has none.
    pub mean_field: Option<Rates>,
}

/// How the waves of a shell relax.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RelaxationRecord {
    /// Lag τ, in frames.
    #[schemars(range(min = 1))]
    pub lag: usize,
    /// D(q), in 1/time, rows first, in components along q and a quarter turn ahead.
    pub matrix: Rates,
    /// Standard errors of the entries of `matrix`.
    pub standard_errors: Rates,
    /// D(q) from the lag 2τ, in 1/time.
    pub matrix_at_twice_the_lag: Rates,
    /// D(q) from covariances that begin at lag zero and thus include localisation errors, in 1/time.
    pub uncorrected: Rates,
    /// Probability of a difference between τ and 2τ at least as large, if waves relax linearly.
    pub linear: f64,
    /// Probability of off-diagonal entries at least as large without chirality.
    pub achiral: f64,
    /// Decay rates, the slower first, in 1/time.
    pub decay_rates: [f64; 2],
    /// Standard errors of `decay_rates`.
    pub decay_errors: [f64; 2],
    /// Angular frequency of the waves, in 1/time.
    pub frequency: f64,
    /// 95 % interval of `frequency`.
    pub frequency_ci95: [f64; 2],
    /// Number of stretches of waves from which the errors are estimated.
    #[schemars(range(min = 1))]
    pub stretches: usize,
    /// Duration of the recording in units of the slowest relaxation time.
    pub relaxations: f64,
    /// Whether `relaxations` is eight or more and `stretches` six or more; if not, the shell is left out of `long_waves`, `linear` and `achiral`.
    pub reliable: bool,
}
