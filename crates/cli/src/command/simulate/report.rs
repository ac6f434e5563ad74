//! What a run was asked for, and what came of it.

use super::start::Origin;
use crate::arguments::{ChosenEffects, OfCells, Spreads};
use schemars::JsonSchema;
use serde::Serialize;
use voronudge_report::ModelParameters;
use voronudge_report::histogram::Histogram;
use voronudge_report::infer_report::RunRecord;
use voronudge_report::numbers::significant;
use voronudge_simulate::{Driving, Method, Walls};

/// Everything that the positions of a run depend on.
#[derive(Serialize, JsonSchema)]
pub(super) struct Request {
    /// Number of cells.
    #[schemars(range(min = 1))]
    pub cells: usize,
    /// Sides of the periodic box, in units of length.
    #[serde(rename = "box")]
    pub box_lengths: [f64; 2],
    /// Where the positions come from.
    pub start: Origin,
    /// Duration, in units of time.
    pub time: f64,
    /// Time step, in units of time.
    pub dt: f64,
    /// Frames kept.
    #[schemars(range(min = 1))]
    pub frames: usize,
    /// Method of integration.
    pub method: Method,
    /// Parameters of the model.
    pub parameters: ModelParameters,
    /// Values (N) of the parameters in which cells differ, in the order of the cells.
    #[serde(rename = "cell_parameters", skip_serializing_if = "OfCells::is_empty")]
    pub of_cells: OfCells,
    /// By how much parameters differ from cell to cell, as asked.
    #[serde(rename = "cell_spread", skip_serializing_if = "Spreads::is_empty")]
    pub spreads: Spreads,
    /// Labels of the cells, which are in a file of their own.
    #[serde(skip)]
    pub labels: Option<Vec<Option<i64>>>,
    /// Effects beyond the base model, by name: their coefficients.
    #[serde(skip_serializing_if = "ChosenEffects::is_empty")]
    pub effects: ChosenEffects,
    /// Sides of the box that are walls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub walls: Option<Walls>,
    /// What moves cells besides the model.
    pub driving: Driving,
}

/// What came of a run.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub(super) run: RunRecord,
    /// What it was asked for, likewise.
    #[serde(flatten)]
    pub(super) request: Request,
    /// ⟨v²⟩ over cells and over the steps in the second half of the run, in (length/time)²; `null` where it was not measured.
    pub(super) mean_square_velocity: Option<f64>,
    /// Its standard error, which knows of correlations in time; `null` where it cannot be told.
    pub(super) mean_square_velocity_error: Option<f64>,
    /// T1 transitions per cell and time in the second half of the run; `null` where they were not counted.
    pub(super) t1_rate: Option<f64>,
    /// Ψ₆ = |(1/N) Σ_i (1/z_i) Σ_j exp(6iθ_ij)| at the end of the run: 1 on a triangular lattice.
    pub(super) hexatic_order: f64,
    /// Mean over cells of the modulus of the same, blind to the orientation of grains.
    pub(super) hexatic_mean_modulus: f64,
    /// Mean stress at the end of the run, in 1/time, force index first.
    pub(super) stress: [[f64; 2]; 2],
    /// Areas A_i of the cells at the end of the run, in length².
    pub(super) area: Spread,
    /// P_i/√A_i of the cells at the end of the run.
    pub(super) shape_index: Spread,
    /// Mean square displacement, in short.
    pub(super) displacement: Displacement,
    /// Structure factor of the density, in short.
    pub(super) structure: Structure,
    /// Largest Lyapunov exponent λ, in 1/time; `null` if it was not asked for.
    pub(super) lyapunov: Option<Exponent>,
    /// Derivatives of the run at its end, for each name of `--sensitivity`; empty without.
    pub(super) sensitivity: Vec<Sensitive>,
    /// Steps made.
    pub(super) steps: usize,
    /// Steps per second of wall time, of the part since `--resume`.
    pub(super) steps_per_second: f64,
}

impl Report {
    /// The cell size ℓ₀.
    pub fn spacing(&self) -> f64 {
        let [width, height] = self.request.box_lengths;
        (width * height / self.request.cells as f64).sqrt()
    }
}

/// How far the cells get, in short.
#[derive(Serialize, JsonSchema)]
pub(super) struct Displacement {
    /// Frames between which displacements were taken.
    pub frames: usize,
    /// The longest lag; `null` for a single frame.
    pub longest_lag: Option<f64>,
    /// Mean square displacement at that lag, in length²; `null` likewise.
    pub mean_square: Option<f64>,
}

/// The structure factor of the density, in short.
#[derive(Serialize, JsonSchema)]
pub(super) struct Structure {
    /// Frames that were averaged.
    pub frames: usize,
    /// Up to which wave number.
    pub largest_wave_number: Option<f64>,
    /// The highest shell.
    pub peak: Option<Peak>,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Peak {
    /// Its mean wave number.
    pub wave_number: f64,
    /// Its structure factor.
    pub value: f64,
}

/// Derivatives by one parameter or starting coordinate at the end of the run, in short.
#[derive(Serialize, JsonSchema)]
pub(super) struct Sensitive {
    /// Name of the parameter or starting coordinate.
    pub by: String,
    /// Root mean square over the cells of the derivatives of positions.
    pub root_mean_square: f64,
    /// Derivative of the mean square velocity.
    pub mean_square_velocity: f64,
    /// Derivative of the mean stress, force index first.
    pub stress: [[f64; 2]; 2],
    /// By how much the runs differ that derivatives are compared with, to either side.
    pub aside: f64,
    /// Share by which derivatives of positions miss the difference of these, at the end; `null` where there is none.
    pub missed: Option<f64>,
    /// Time of the last frame up to which that is at most a tenth; `null` if there is none.
    pub agrees_until: Option<f64>,
}

impl Sensitive {
    /// For how long derivatives agree with differences of a run of some time, in words.
    pub fn agreement(&self, time: f64) -> String {
        match self.agrees_until {
            Some(until) if until >= time * (1.0 - 1e-9) => "they tell small changes to 10 % all along".into(),
            Some(until) => format!("they tell small changes to 10 % until t = {}", significant(until, 3)),
            None => "they do not tell small changes to 10 % even in the first frame".into(),
        }
    }
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Exponent {
    /// The exponent.
    pub value: f64,
    /// Its standard error.
    pub standard_error: Option<f64>,
}

/// Mean and standard deviation over cells, and a histogram.
#[derive(Serialize, JsonSchema)]
pub(super) struct Spread {
    /// Mean over cells.
    pub mean: f64,
    /// Standard deviation over cells.
    pub standard_deviation: f64,
    /// Number of cells in each bin; `null` if no value is finite.
    pub histogram: Option<Counts>,
}

/// Number of cells in each bin.
#[derive(Serialize, JsonSchema)]
pub(super) struct Counts {
    /// Lower edge of the first bin.
    pub from: f64,
    /// Width of a bin.
    pub width: f64,
    /// Cells in each bin.
    pub counts: Vec<usize>,
}

/// Bins of a histogram in the report, about.
const BINS: usize = 30;

impl Spread {
    pub fn of(values: &[f64]) -> Self {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let [low, high] = values
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)]);
        // A lattice has cells of one size to rounding.
        let room = 1e-6 * high.abs() + 1e-9 * (high - low);
        let bins = Histogram::new(values.iter().copied(), [low - room, high + room], BINS);
        let histogram = bins.map(|bins| Counts {
            from: bins.range()[0],
            width: bins.width(),
            counts: bins.counts.iter().map(|&count| count as usize).collect(),
        });
        Self { mean, standard_deviation: variance.sqrt(), histogram }
    }
}
