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
    /// Where the starting positions come from.
    pub start: Origin,
    /// Duration, in units of time.
    pub time: f64,
    /// Time step, in units of time.
    pub dt: f64,
    /// Number of frames kept.
    #[schemars(range(min = 1))]
    pub frames: usize,
    /// Method of integration.
    pub method: Method,
    /// Parameters of the model.
    pub parameters: ModelParameters,
    /// Values (N) of the parameters in which cells differ, by name, in the order of the cells.
    #[serde(rename = "cell_parameters", skip_serializing_if = "OfCells::is_empty")]
    pub of_cells: OfCells,
    /// How much parameters differ from cell to cell, as requested.
    #[serde(rename = "cell_spread", skip_serializing_if = "Spreads::is_empty")]
    pub spreads: Spreads,
    /// Labels of the cells, which are in a file of their own.
    #[serde(skip)]
    pub labels: Option<Vec<Option<i64>>>,
    /// Coefficients of the effects beyond the base model, by name of the effect.
    #[serde(skip_serializing_if = "ChosenEffects::is_empty")]
    pub effects: ChosenEffects,
    /// Sides of the box that are walls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub walls: Option<Walls>,
    /// What moves the cells in addition to the model.
    pub driving: Driving,
}

/// What came of a run.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub(super) run: RunRecord,
    /// What was requested, also at the top level of the file.
    #[serde(flatten)]
    pub(super) request: Request,
    /// ⟨v²⟩ over cells and over the steps in the second half of the run, in (length/time)²; `null` where it was not measured.
    pub(super) mean_square_velocity: Option<f64>,
    /// Standard error of `mean_square_velocity`, which accounts for correlations in time; `null` where it cannot be determined.
    pub(super) mean_square_velocity_error: Option<f64>,
    /// T1 transitions per cell and time in the second half of the run; `null` where they were not counted.
    pub(super) t1_rate: Option<f64>,
    /// Ψ₆ = |(1/N) Σ_i (1/z_i) Σ_j exp(6iθ_ij)| at the end of the run: 1 on a triangular lattice.
    pub(super) hexatic_order: f64,
    /// Mean over the cells of |(1/z_i) Σ_j exp(6iθ_ij)|, which does not depend on the orientation of grains.
    pub(super) hexatic_mean_modulus: f64,
    /// Mean stress at the end of the run, in 1/time; force index first.
    pub(super) stress: [[f64; 2]; 2],
    /// Areas A_i of the cells at the end of the run, in length².
    pub(super) area: Spread,
    /// Shape indices P_i/√A_i of the cells at the end of the run.
    pub(super) shape_index: Spread,
    /// Summary of the mean square displacement.
    pub(super) displacement: Displacement,
    /// Summary of the structure factor of the density.
    pub(super) structure: Structure,
    /// Largest Lyapunov exponent λ, in 1/time; `null` if it was not requested.
    pub(super) lyapunov: Option<Exponent>,
    /// Derivatives at the end of the run with respect to each name of `--sensitivity`; empty without it.
    pub(super) sensitivity: Vec<Sensitive>,
    /// Number of time steps made.
    pub(super) steps: usize,
    /// Steps per second of wall time, for the part since `--resume`.
    pub(super) steps_per_second: f64,
}

impl Report {
    /// The cell size ℓ₀.
    pub fn spacing(&self) -> f64 {
        let [width, height] = self.request.box_lengths;
        (width * height / self.request.cells as f64).sqrt()
    }
}

/// Summary of the mean square displacement.
#[derive(Serialize, JsonSchema)]
pub(super) struct Displacement {
    /// Number of frames between which displacements were taken.
    pub frames: usize,
    /// Longest lag, in units of time; `null` for a single frame.
    pub longest_lag: Option<f64>,
    /// Mean square displacement at that lag, in length²; `null` for a single frame.
    pub mean_square: Option<f64>,
}

/// Summary of the structure factor of the density.
#[derive(Serialize, JsonSchema)]
pub(super) struct Structure {
    /// Number of frames that were averaged.
    pub frames: usize,
    /// Largest wave number included, in 1/length; `null` if there are no shells of wave numbers.
    pub largest_wave_number: Option<f64>,
    /// The shell with the largest structure factor; `null` if there are no shells.
    pub peak: Option<Peak>,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Peak {
    /// Mean wave number of the shell, in 1/length.
    pub wave_number: f64,
    /// Structure factor of the shell.
    pub value: f64,
}

/// Derivatives with respect to one parameter or starting coordinate, at the end of the run.
#[derive(Serialize, JsonSchema)]
pub(super) struct Sensitive {
    /// Name of the parameter or starting coordinate.
    pub by: String,
    /// Root mean square, over the cells, of the derivatives of the positions.
    pub root_mean_square: f64,
    /// Derivative of the mean square velocity.
    pub mean_square_velocity: f64,
    /// Derivative of the mean stress; force index first.
    pub stress: [[f64; 2]; 2],
    /// Change of the parameter or coordinate, to either side, in the two runs with which the derivatives are compared.
    pub aside: f64,
    /// Relative deviation of the derivatives of positions from the difference of these two runs, at the end; `null` if one of them could not go on.
    pub missed: Option<f64>,
    /// Time of the last frame up to which this deviation is at most a tenth; `null` if there is none.
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
    /// The exponent, in 1/time.
    pub value: f64,
    /// Standard error of the exponent; `null` where it is not known.
    pub standard_error: Option<f64>,
}

/// Mean and standard deviation over cells, and a histogram.
#[derive(Serialize, JsonSchema)]
pub(super) struct Spread {
    /// Mean over cells.
    pub mean: f64,
    /// Standard deviation over cells.
    pub standard_deviation: f64,
    /// Histogram of the values; `null` if no value is finite.
    pub histogram: Option<Counts>,
}

/// A histogram with bins of equal width.
#[derive(Serialize, JsonSchema)]
pub(super) struct Counts {
    /// Lower edge of the first bin.
    pub from: f64,
    /// Width of a bin.
    pub width: f64,
    /// Number of cells in each bin.
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
