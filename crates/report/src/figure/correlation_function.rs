//! How residuals at a distance from each other correlate, before and after.

use super::no_data;
use crate::before_after::BeforeAfter;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREY, VERMILLION};
use crate::key::KeyEntry;
use crate::series::ErrorPoint;
use crate::svg::PathData;
use crate::view::is_finite;

/// Colour and line of the curves before and after.
const STYLES: [(&str, &str); 2] = [(VERMILLION, "6 4"), (BLUE, "none")];

/// Which components of two residuals are multiplied, with d̂ the direction from one to the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correlation {
    /// Along d̂ with along d̂.
    Longitudinal,
    /// Across d̂ with across d̂.
    Transverse,
    /// Along d̂ with across d̂: zero unless something turns.
    Chiral,
}

impl Correlation {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Longitudinal => "longitudinal",
            Self::Transverse => "transverse",
            Self::Chiral => "chiral",
        }
    }

    /// What it tells.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Longitudinal => {
                "longitudinal: components along the line between two cells. Above zero, cells in line go \
                 the same way."
            }
            Self::Transverse => {
                "transverse: components across that line. Above zero, cells side by side go the same way; \
                 below zero, they pass or circle each other."
            }
            Self::Chiral => {
                "chiral: one component along, the other across. Zero in a tissue without handedness."
            }
        }
    }
}

/// The correlation at one distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrelationPoint {
    /// Distance in units of the cell size ℓ₀.
    pub distance: f64,
    /// Correlation over the mean square of a component.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// One correlation function of the residual, before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelationFunction {
    /// Which components are multiplied.
    pub correlation: Correlation,
    /// Its values by increasing distance; leave those after empty if no effect was added.
    pub points: BeforeAfter<Vec<CorrelationPoint>>,
}

/// Correlation against distance with bands of one standard error; before dashed, after solid.
#[must_use]
pub fn correlation_function(function: &CorrelationFunction) -> String {
    let name = function.correlation.name();
    let title = format!("{name} correlation of the residual");
    let curves = [&function.points.before, &function.points.after].map(|points| drawable(points));
    let all = || curves.iter().flatten();
    let ends =
        all().flat_map(|point| [point.value - point.standard_error, point.value + point.standard_error]);
    let [low, high] = ends.fold([-0.1f64, 0.1f64], |[low, high], end| [low.min(end), high.max(end)]);
    let reach = all().map(|point| point.distance).fold(0.0, f64::max);
    let room = 0.08 * (high - low);
    let layout = ChartLayout {
        title: &title,
        size: [400.0, 270.0],
        left: 58.0,
        x: Axis::linear("distance / ℓ_0", [0.0, 1.03 * reach]),
        y: Axis::linear(&format!("{name} correlation"), [low - room, high + room]),
    };
    let chart = Chart::new(layout).filter(|_| reach > 0.0);
    let Some(mut chart) = chart else {
        return no_data(&title);
    };
    let zero = [[0.0, 0.0], [1.03 * reach, 0.0]];
    chart.curve(&zero, &format!(r#"stroke="{GREY}" stroke-width="1""#));
    let mut key = Vec::new();
    for ((points, (colour, dashes)), name) in curves.iter().zip(STYLES).zip(["before", "after"]) {
        if points.is_empty() {
            continue;
        }
        let edge = |sign: f64| {
            move |point: &CorrelationPoint| [point.distance, point.value + sign * point.standard_error]
        };
        let outline = points.iter().map(edge(1.0)).chain(points.iter().rev().map(edge(-1.0)));
        let outline: Vec<[f64; 2]> = outline.map(|point| chart.to_pixel(point)).collect();
        let mut band = PathData::new();
        band.polygon(&outline);
        chart.svg.path(&band, &format!(r#"fill="{colour}" opacity=".18""#));
        let style = format!(r#"stroke="{colour}" stroke-width="1.8" stroke-dasharray="{dashes}""#);
        let line: Vec<[f64; 2]> = points.iter().map(|point| [point.distance, point.value]).collect();
        let errors = points.iter().map(|point| [None, Some(point.standard_error)]);
        chart.record(name, line.iter().zip(errors).map(|(&at, error)| ErrorPoint { at, error }));
        chart.curve(&line, &style);
        key.push(KeyEntry::line(name, &style));
    }
    chart.frame();
    chart.finish_with_key(&key)
}

/// The points that can be drawn; one without a standard error has none to show.
fn drawable(points: &[CorrelationPoint]) -> Vec<CorrelationPoint> {
    let known = points.iter().filter(|point| is_finite([point.distance, point.value]));
    let error = |error: f64| if error.is_finite() { error.abs() } else { 0.0 };
    known.map(|point| CorrelationPoint { standard_error: error(point.standard_error), ..*point }).collect()
}
