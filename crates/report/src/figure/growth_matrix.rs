//! Entries of the growth matrix D(q) against the square of the wave vector.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREEN, GREY, INK, VERMILLION};
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::numbers::quantile;
use crate::series::ErrorPoint;
use crate::svg::PathData;
use crate::units::Units;
use crate::units::label_with_unit;

/// The matrix of one wave vector, fitted to it alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthPoint {
    /// q².
    pub square: f64,
    /// D(q) in components along q and a quarter turn ahead, rows first.
    pub matrix: [[f64; 2]; 2],
    /// Standard errors of its entries.
    pub errors: [[f64; 2]; 2],
}

/// The matrix that was fitted to all wave vectors, at one q².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthCurve {
    /// q².
    pub square: f64,
    /// D(q).
    pub matrix: [[f64; 2]; 2],
}

/// The entries with bars of one standard error, and the lines fitted to all of them.
#[must_use]
pub fn growth_matrix(points: &[GrowthPoint], curve: &[GrowthCurve], units: &Units) -> String {
    let title = "growth matrix against the square of the wave vector";
    let end = curve.iter().map(|point| point.square).fold(0.0, f64::max);
    // Entries that the data hardly determine shall not stretch the axis; the fit is always seen.
    let sure = points.iter().flat_map(|point| (0..4).map(|k| point.matrix[k / 2][k % 2]));
    let fitted = || curve.iter().flat_map(|point| (0..4).map(|k| point.matrix[k / 2][k % 2]));
    let low = quantile(sure.clone(), 0.02).unwrap_or(0.0).min(fitted().fold(0.0, f64::min));
    let high = quantile(sure, 0.98).unwrap_or(0.0).max(fitted().fold(0.0, f64::max));
    let room = 0.08 * (high - low);
    let layout = ChartLayout {
        title,
        size: [560.0, 380.0],
        left: 70.0,
        x: Axis::linear(&label_with_unit("q²", &units.powers(-2, 0)), [0.0, 1.03 * end]),
        y: Axis::linear(&label_with_unit("entry of D(q)", &units.powers(0, -1)), [low - room, high + room]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    let zero = [[0.0, 0.0], [1.03 * end, 0.0]];
    chart.curve(&zero, &format!(r#"stroke="{INK}" stroke-width=".8" stroke-dasharray="3 3""#));
    let entries = [
        ("D∥∥", 0, 0, BLUE, Marker::Circle),
        ("D⊥⊥", 1, 1, GREEN, Marker::Square),
        ("D∥⊥", 0, 1, VERMILLION, Marker::Diamond),
        ("D⊥∥", 1, 0, GREY, Marker::Triangle),
    ];
    let mut key = Vec::new();
    for (name, row, column, colour, marker) in entries {
        let line_style = format!(r#"stroke="{colour}" stroke-width="1.6""#);
        let line: Vec<[f64; 2]> =
            curve.iter().map(|point| [point.square, point.matrix[row][column]]).collect();
        chart.record(&format!("{name}, fitted"), line.iter().copied());
        chart.record(
            name,
            points.iter().map(|point| ErrorPoint {
                at: [point.square, point.matrix[row][column]],
                error: [None, Some(point.errors[row][column])],
            }),
        );
        chart.clipped_curve(&line, &line_style);
        let [mut bars, mut marks] = [PathData::new(), PathData::new()];
        for point in points {
            let (value, error) = (point.matrix[row][column], point.errors[row][column]);
            let clamp = |y: f64| y.clamp(low - room, high + room);
            if error.is_finite() && chart.contains([point.square, value]) {
                let ends = [value - error, value + error].map(|y| chart.to_pixel([point.square, clamp(y)]));
                bars.line(&ends);
                marker.push(&mut marks, chart.to_pixel([point.square, value]), 3.0);
            }
        }
        chart.svg.path(&bars, &format!(r#"fill="none" stroke="{colour}" stroke-width="1""#));
        let mark_style = format!(r##"fill="#fff" stroke="{colour}" stroke-width="1.2""##);
        chart.svg.path(&marks, &mark_style);
        key.push(KeyEntry::new(name, |svg, at| {
            let mut mark = PathData::new();
            marker.push(&mut mark, at, 3.4);
            svg.path(&mark, &mark_style);
        }));
    }
    chart.frame();
    chart.finish_with_key(&key)
}
