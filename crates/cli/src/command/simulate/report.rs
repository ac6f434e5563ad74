//! What a run was asked for, and what came of it.

use super::start::Origin;
use crate::arguments::ChosenEffects;
use crate::command::evaluate::ModelParameters;
use serde::Serialize;
use voronudge_report::infer_report::RunRecord;
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
    #[serde(skip_serializing_if = "ChosenEffects::is_empty")]
    pub effects: ChosenEffects,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub walls: Option<Walls>,
    pub driving: Driving,
}

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
    pub steps: usize,
    pub steps_per_second: f64,
}

/// Mean and standard deviation over cells.
#[derive(Serialize)]
pub(super) struct Spread {
    pub mean: f64,
    pub standard_deviation: f64,
}

impl Spread {
    pub fn of(values: &[f64]) -> Self {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        Self { mean, standard_deviation: variance.sqrt() }
    }
}
