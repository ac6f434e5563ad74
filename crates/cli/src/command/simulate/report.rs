//! What a run was asked for, and what came of it.

use super::start::Origin;
use crate::arguments::{ChosenEffects, OfCells, Spreads};
use crate::command::evaluate::ModelParameters;
use serde::Serialize;
use voronudge_report::histogram::Histogram;
use voronudge_report::infer_report::RunRecord;
use voronudge_report::numbers::significant;
use voronudge_simulate::{Driving, Method, Walls};

/// Everything that the positions of a run depend on.
#[derive(Serialize)]
pub(super) struct Request {
    pub cells: usize,
    #[serde(rename = "box")]
    pub box_lengths: [f64; 2],
    pub start: Origin,
    pub time: f64,
    pub dt: f64,
    pub frames: usize,
    pub method: Method,
    pub parameters: ModelParameters,
    #[serde(rename = "cell_parameters", skip_serializing_if = "OfCells::is_empty")]
    pub of_cells: OfCells,
    #[serde(rename = "cell_spread", skip_serializing_if = "Spreads::is_empty")]
    pub spreads: Spreads,
    /// Labels of the cells, which are in a file of their own.
    #[serde(skip)]
    pub labels: Option<Vec<Option<i64>>>,
    #[serde(skip_serializing_if = "ChosenEffects::is_empty")]
    pub effects: ChosenEffects,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub walls: Option<Walls>,
    pub driving: Driving,
}

/// What came of a run, described by a schema beside those of the other reports.
#[derive(Serialize)]
pub(super) struct Report {
    #[serde(flatten)]
    pub run: RunRecord,
    #[serde(flatten)]
    pub request: Request,
    pub mean_square_velocity: Option<f64>,
    pub mean_square_velocity_error: Option<f64>,
    pub t1_rate: Option<f64>,
    pub hexatic_order: f64,
    pub hexatic_mean_modulus: f64,
    pub stress: [[f64; 2]; 2],
    pub area: Spread,
    pub shape_index: Spread,
    pub displacement: Displacement,
    pub structure: Structure,
    pub lyapunov: Option<Exponent>,
    pub sensitivity: Vec<Sensitive>,
    pub steps: usize,
    pub steps_per_second: f64,
}

impl Report {
    /// The cell size ℓ₀.
    pub fn spacing(&self) -> f64 {
        let [width, height] = self.request.box_lengths;
        (width * height / self.request.cells as f64).sqrt()
    }
}

/// How far the cells get, in short.
#[derive(Serialize)]
pub(super) struct Displacement {
    /// Frames between which displacements were taken.
    pub frames: usize,
    pub longest_lag: Option<f64>,
    pub mean_square: Option<f64>,
}

/// The structure factor of the density, in short.
#[derive(Serialize)]
pub(super) struct Structure {
    /// Frames that were averaged.
    pub frames: usize,
    pub largest_wave_number: Option<f64>,
    pub peak: Option<Peak>,
}

#[derive(Serialize)]
pub(super) struct Peak {
    pub wave_number: f64,
    pub value: f64,
}

/// Derivatives by one parameter or starting coordinate at the end of the run, in short.
#[derive(Serialize)]
pub(super) struct Sensitive {
    /// Its name.
    pub by: String,
    /// Of positions, over the cells.
    pub root_mean_square: f64,
    pub mean_square_velocity: f64,
    pub stress: [[f64; 2]; 2],
    /// By how much the runs differ that derivatives are compared with, to either side.
    pub aside: f64,
    /// By which share derivatives of positions miss the difference of these, at the end.
    pub missed: Option<f64>,
    /// Time of the last frame up to which that is at most a tenth.
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

#[derive(Serialize)]
pub(super) struct Exponent {
    pub value: f64,
    pub standard_error: Option<f64>,
}

/// Mean and standard deviation over cells, and a histogram.
#[derive(Serialize)]
pub(super) struct Spread {
    pub mean: f64,
    pub standard_deviation: f64,
    pub histogram: Option<Counts>,
}

/// Number of cells in each bin.
#[derive(Serialize)]
pub(super) struct Counts {
    pub from: f64,
    pub width: f64,
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
