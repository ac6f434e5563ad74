//! Measured points with error bars, and curves beside them.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::INK;
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::svg::PathData;

/// A measured point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorPoint {
    /// Place in axis coordinates.
    pub at: [f64; 2],
    /// Standard error along each axis, where known.
    pub error: [Option<f64>; 2],
}

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSeries<'a> {
    /// Name in the key; `_x` sets a subscript.
    pub label: &'a str,
    /// Colour.
    pub colour: &'a str,
    /// Mark of a point.
    pub marker: Marker,
    /// The points.
    pub points: Vec<ErrorPoint>,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// As one line.
    Solid,
    /// Dashed.
    Dashed,
    /// Dotted.
    Dotted,
}

/// A curve beside the points.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveSeries<'a> {
    /// Name in the key; `_x` sets a subscript.
    pub label: &'a str,
    /// Colour.
    pub colour: &'a str,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Places along the curve in axis coordinates.
    pub points: Vec<[f64; 2]>,
}

/// What the chart is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointsAndCurves<'a> {
    /// What a screen reader says.
    pub title: &'a str,
    /// Labels of the axes with units.
    pub labels: [&'a str; 2],
    /// Measured points.
    pub series: &'a [PointSeries<'a>],
    /// Curves.
    pub curves: &'a [CurveSeries<'a>],
}

/// Points with bars of one standard error, curves, and a line at zero where it lies on the axis. The axes hold all points and bars;
/// curves are cut off.
#[must_use]
pub fn points_and_curves(chart: &PointsAndCurves<'_>) -> String {
    let finite = |point: &&ErrorPoint| point.at.iter().all(|x| x.is_finite());
    let points = || chart.series.iter().flat_map(|series| series.points.iter().filter(finite));
    let range = |axis: usize| {
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        let mut hold = |x: f64| ends = [ends[0].min(x), ends[1].max(x)];
        for point in points() {
            let reach = point.error[axis].filter(|error| error.is_finite()).unwrap_or(0.0);
            hold(point.at[axis] - reach);
            hold(point.at[axis] + reach);
        }
        if points().next().is_none() {
            chart.curves.iter().flat_map(|curve| &curve.points).for_each(|at| hold(at[axis]));
        }
        let room = 0.04 * (ends[1] - ends[0]);
        // Distances begin at the edge.
        let begin = if ends[0] >= 0.0 && ends[0] < 0.2 * ends[1] { 0.0 } else { ends[0] - room };
        [begin, ends[1] + room]
    };
    let layout = ChartLayout {
        title: chart.title,
        size: [440.0, 290.0],
        left: 66.0,
        x: Axis::linear(chart.labels[0], range(0)),
        y: Axis::linear(chart.labels[1], range(1)),
    };
    let Some(mut picture) = Chart::new(layout) else {
        return no_data(chart.title);
    };
    let [x, _] = picture.axes();
    let zero = [[x.range[0], 0.0], [x.range[1], 0.0]];
    if picture.contains(zero[0]) {
        picture.curve(&zero, &format!(r#"stroke="{INK}" stroke-width=".8""#));
    }
    for curve in chart.curves {
        picture.clipped_curve(&curve.points, &curve_style(curve));
    }
    for series in chart.series {
        draw_points(&mut picture, series);
    }
    picture.frame();
    let points = chart.series.iter().map(|series| {
        KeyEntry::new(series.label, |svg, middle| {
            let mut mark = PathData::new();
            series.marker.push(&mut mark, middle, MARK);
            svg.path(&mark, &format!(r#"fill="{}""#, series.colour));
        })
    });
    let curves = chart.curves.iter().map(|curve| KeyEntry::line(curve.label, &curve_style(curve)));
    picture.finish_with_key(&points.chain(curves).filter(|entry| !entry.label.is_empty()).collect::<Vec<_>>())
}

/// Half the size of a mark in pixels.
const MARK: f64 = 2.8;

fn curve_style(curve: &CurveSeries<'_>) -> String {
    let dashes = match curve.stroke {
        Stroke::Solid => "",
        Stroke::Dashed => r#" stroke-dasharray="6 4""#,
        Stroke::Dotted => r#" stroke-dasharray="1.5 3""#,
    };
    format!(r#"stroke="{}" stroke-width="1.6" stroke-linejoin="round"{dashes}"#, curve.colour)
}

fn draw_points(chart: &mut Chart, series: &PointSeries<'_>) {
    let (mut bars, mut marks) = (PathData::new(), PathData::new());
    for point in series.points.iter().filter(|point| chart.contains(point.at)) {
        for axis in [0, 1] {
            if let Some(error) = point.error[axis].filter(|error| error.is_finite()) {
                let end = |sign: f64| {
                    let mut at = point.at;
                    at[axis] += sign * error;
                    chart.place(at)
                };
                bars.line(&[end(-1.0), end(1.0)]);
            }
        }
        series.marker.push(&mut marks, chart.place(point.at), MARK);
    }
    chart
        .svg
        .path(&bars, &format!(r#"fill="none" stroke="{}" stroke-width="1" opacity=".7""#, series.colour));
    chart.svg.path(&marks, &format!(r#"fill="{}""#, series.colour));
}
