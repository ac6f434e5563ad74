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
    /// Frames used, zero-based.
    pub frames: Vec<usize>,
    /// Time between two of them.
    pub frame_interval: Quantity,
    /// Cells seen in each.
    pub seen: Vec<usize>,
    /// The cell size: root of the mean area of the cells that count.
    pub length_scale: Quantity,
    /// Whether velocities were given, or are displacements.
    #[schemars(extend("enum" = ["given", "from_positions", "none"]))]
    pub velocities: &'static str,
    /// Whether the median motion of the cells is taken for one of the stage.
    pub common_motion_removed: bool,
    /// What was resolved into waves.
    #[schemars(extend("enum" = ["displacements", "velocities"]))]
    pub field: &'static str,
    /// Lag τ₀ in frames, from which covariances are used.
    pub first_lag: usize,
    /// Parameters of the model whose D(q) stands beside, in units of the data; `null` if none are given.
    pub parameters: Option<ModelParameters>,
    /// Probability of differences of D from τ and 2τ that are as large if waves relax linearly and without memory, of all reliable shells together; `null` where that cannot be told.
    pub linear: Option<f64>,
    /// What that says: `not_linear` below 0.01.
    #[schemars(extend("enum" = ["linear", "not_linear", "unknown"]))]
    pub verdict: &'static str,
    /// Probability of entries off the diagonal that are as large without chirality, of all reliable shells together; `null` where that cannot be told.
    pub achiral: Option<f64>,
    /// σ_r of errors of localisation without memory; `null` if velocities were resolved or it cannot be told.
    pub localisation: Option<Measured>,
    /// Moduli over friction, from waves longer than 2π spacings of a periodic box; `null` where there are none.
    pub long_waves: Option<LongWavesRecord>,
    /// Segments of the dynamic structure factors; `null` where there are none.
    pub spectra: Option<SpectraRecord>,
    /// Shells of wave numbers, ascending.
    pub shells: Vec<WaveShellRecord>,
}

/// A number with its error.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Measured {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Unit.
    pub unit: String,
}

/// D over q² of long waves.
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
    /// Shells that they are means of.
    #[schemars(range(min = 1))]
    pub shells: usize,
}

/// How spectra were taken.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpectraRecord {
    /// Frames of a segment.
    #[schemars(range(min = 2))]
    pub segment: usize,
    /// Number of segments, which overlap by half.
    #[schemars(range(min = 1))]
    pub segments: usize,
    /// Angular frequencies, in 1/time.
    pub frequencies: Vec<f64>,
}

/// One shell.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WaveShellRecord {
    /// Mean wave number, in 1/length.
    pub wave_number: f64,
    /// Wave vectors, one of each pair ±q.
    #[schemars(range(min = 1))]
    pub wave_vectors: usize,
    /// How waves relax; `null` where that cannot be told.
    pub relaxation: Option<RelaxationRecord>,
    /// D(q) of the Jacobian, a wave being put on all cells alike; `null` without a model.
    pub jacobian: Option<Rates>,
    /// The inverse of the compliance to waves of forces, likewise.
    pub jacobian_relaxed: Option<Rates>,
    /// D(q) of the honeycomb, averaged over directions; `null` without a model, or where there is none.
    pub mean_field: Option<Rates>,
}

/// How the waves of a shell relax.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RelaxationRecord {
    /// Lag τ in frames.
    #[schemars(range(min = 1))]
    pub lag: usize,
    /// D(q), in 1/time, in components along q and a quarter turn ahead.
    pub matrix: Rates,
    /// Standard errors of its entries.
    pub standard_errors: Rates,
    /// D(q) from 2τ.
    pub matrix_at_twice_the_lag: Rates,
    /// D(q) from lag zero on, with the errors of localisation in it.
    pub uncorrected: Rates,
    /// Probability of the difference between τ and 2τ if waves relax linearly.
    pub linear: f64,
    /// Probability of the entries off the diagonal without chirality.
    pub achiral: f64,
    /// Decay rates, the slower first, in 1/time.
    pub decay_rates: [f64; 2],
    /// Their standard errors.
    pub decay_errors: [f64; 2],
    /// Angular frequency, in 1/time.
    pub frequency: f64,
    /// Its 95 % interval.
    pub frequency_ci95: [f64; 2],
    /// Stretches of waves that errors come from.
    #[schemars(range(min = 1))]
    pub stretches: usize,
    /// Times of the slowest relaxation in the recording.
    pub relaxations: f64,
    /// Whether these are eight or more and the stretches six or more; else the shell is left out of `long_waves`, `linear` and `achiral`.
    pub reliable: bool,
}
