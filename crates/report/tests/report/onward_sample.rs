//! What models make of cells, for the tests and the example.

use voronudge_report::discover_report::{
    ByModel, CheckReport, CheckedQuantity, ForecastReport, Forecasters, Gain, Simulated,
};
use voronudge_report::figure::{Trails, trails};
use voronudge_report::infer_report::Quantity;
use voronudge_report::page::Figure;

use crate::sample::noise;

/// Where cells went, measured and simulated.
pub fn ways() -> Figure {
    let way = |cell: usize, stream: u64| -> Vec<[f64; 2]> {
        let start = [(cell % 8) as f64, (cell / 8) as f64];
        (0..6).map(|frame| start.map(|x| x + 0.1 * f64::from(frame) * noise(cell, stream))).collect()
    };
    let movies: Vec<Vec<_>> =
        (70..73).map(|stream| (0..64).map(|cell| way(cell, stream)).collect()).collect();
    let labels = ["measured", "base model", "with effects"];
    let panels: Vec<Trails<'_>> =
        labels.iter().zip(&movies).map(|(label, ways)| Trails { label, ways }).collect();
    Figure::new(trails("ways of the cells", &panels, "um"), "Ways of the cells.")
}

/// Skills that fall with the horizon.
pub fn forecast() -> ForecastReport {
    let skills = |first: f64, fall: f64| -> Vec<Gain> {
        (0..4)
            .map(|h| Gain { value: first - fall * f64::from(h), standard_error: 0.01 + 0.004 * f64::from(h) })
            .collect()
    };
    let all = |shift: f64| Forecasters {
        base: skills(0.31 - shift, 0.02),
        extended: Some(skills(0.58 - shift, 0.03)),
        no_motion: skills(0.0, 0.0),
        constant_velocity: skills(0.4 - shift, 0.12),
        regression: vec![Gain { value: f64::NAN, standard_error: f64::NAN }; 4],
    };
    let lengths = |first: f64| -> Vec<f64> { (1..5).map(|h| first * f64::from(h).sqrt()).collect() };
    let errors = |model: f64, baseline: f64| Forecasters {
        base: lengths(model),
        extended: Some(lengths(0.8 * model)),
        no_motion: lengths(baseline),
        constant_velocity: lengths(baseline),
        regression: lengths(f64::NAN),
    };
    ForecastReport {
        starts: vec![8, 9, 10, 11, 12],
        horizons: vec![1, 2, 3, 4],
        interval: Quantity { value: 5.0, unit: "min".into() },
        scored: vec![1510, 1208, 903, 601],
        skill: all(0.0),
        velocity_skill: all(0.1),
        gain: Some(skills(0.27, 0.01)),
        best_possible: vec![0.91, 0.95, 0.97, 0.98],
        error: errors(1.4, 2.1),
        expected_error: errors(1.3, f64::NAN),
        unit: "um".into(),
        words: "One frame ahead the model with density_gradient has a skill of 0.58, the base model of 0.31."
            .into(),
    }
}

/// The displacement tells the base model from the measured cells, the shapes do not.
pub fn check() -> CheckReport {
    let simulated = |p: f64, value: &[f64]| {
        let times = |factor: f64| value.iter().map(|value| factor * value).collect();
        Simulated { p, low: times(0.8), median: times(1.0), high: times(1.2) }
    };
    let lags: Vec<f64> = (1..6).map(|lag| 5.0 * f64::from(lag)).collect();
    let squares = |slope: f64| -> Vec<f64> { lags.iter().map(|lag| slope * lag).collect() };
    let moved = CheckedQuantity {
        name: "mean_square_displacement",
        words: "mean square displacement",
        axis: "lag",
        axis_unit: "min".into(),
        unit: "um^2".into(),
        at: lags.clone(),
        measured: squares(0.9),
        simulated: ByModel {
            base: simulated(0.005, &squares(0.4)),
            extended: Some(simulated(0.4, &squares(0.92))),
        },
    };
    let shape = CheckedQuantity {
        name: "mean_shape_index",
        words: "mean shape index",
        axis: "",
        axis_unit: String::new(),
        unit: String::new(),
        at: vec![0.0],
        measured: vec![3.9],
        simulated: ByModel { base: simulated(0.3, &[3.9]), extended: Some(simulated(0.6, &[3.91])) },
    };
    CheckReport {
        frames: (3..14).collect(),
        draws: 199,
        p: ByModel { base: 0.005, extended: Some(0.31) },
        quantities: vec![moved, shape],
        words: "The base model does not make such cells (p 0.005): mean square displacement.".into(),
    }
}
