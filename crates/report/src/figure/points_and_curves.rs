//! Measured points with error bars, and curves beside them.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout};
use crate::colour::INK;
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::series::ErrorPoint;
use crate::svg::PathData;

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
    /// How values are spread along the axes; what a logarithm cannot show is left out.
    pub scales: [AxisScale; 2],
    /// Measured points.
    pub series: &'a [PointSeries<'a>],
    /// Curves.
    pub curves: &'a [CurveSeries<'a>],
}

impl PointsAndCurves<'_> {
    fn shows(&self, at: [f64; 2]) -> bool {
        let fits = |(x, scale): (f64, AxisScale)| x.is_finite() && (scale == AxisScale::Linear || x > 0.0);
        at.into_iter().zip(self.scales).all(fits)
    }

    /// An axis that holds all points and their bars; without points, all curves.
    fn axis(&self, which: usize) -> Option<Axis> {
        let points = || {
            self.series.iter().flat_map(|series| series.points.iter().filter(|point| self.shows(point.at)))
        };
        let mut held = Vec::new();
        for point in points() {
            let reach = point.error[which].filter(|error| error.is_finite()).unwrap_or(0.0);
            held.extend([point.at[which] - reach, point.at[which] + reach]);
        }
        if held.is_empty() {
            let places = self.curves.iter().flat_map(|curve| &curve.points);
            held.extend(places.filter(|at| self.shows(**at)).map(|at| at[which]));
        }
        Axis::holding(self.labels[which], self.scales[which], held.into_iter())
    }
}

/// Points with bars of one standard error, curves, and a line at zero where it lies on the axis. The axes hold all points and bars;
/// curves are cut off.
#[must_use]
pub fn points_and_curves(chart: &PointsAndCurves<'_>) -> String {
    let axes = chart.axis(0).zip(chart.axis(1));
    let layout =
        axes.map(|(x, y)| ChartLayout { title: chart.title, size: [440.0, 290.0], left: 66.0, x, y });
    let Some(mut picture) = layout.and_then(Chart::new) else {
        return no_data(chart.title);
    };
    let [x, _] = picture.axes();
    let zero = [[x.range[0], 0.0], [x.range[1], 0.0]];
    if chart.scales[1] == AxisScale::Linear && picture.contains(zero[0]) {
        picture.curve(&zero, &format!(r#"stroke="{INK}" stroke-width=".8""#));
    }
    for curve in chart.curves {
        let place = |&at: &[f64; 2]| if chart.shows(at) { at } else { [f64::NAN; 2] };
        let points: Vec<[f64; 2]> = curve.points.iter().map(place).collect();
        picture.record(curve.label, points.iter().copied());
        picture.clipped_curve(&points, &curve_style(curve));
    }
    for series in chart.series {
        picture.record(series.label, series.points.iter().copied());
        draw_points(&mut picture, chart, series);
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

fn draw_points(chart: &mut Chart, figure: &PointsAndCurves<'_>, series: &PointSeries<'_>) {
    let (mut bars, mut marks) = (PathData::new(), PathData::new());
    let shown = series.points.iter().filter(|point| figure.shows(point.at) && chart.contains(point.at));
    for point in shown {
        for axis in [0, 1] {
            if let Some(error) = point.error[axis].filter(|error| error.is_finite()) {
                let end = |sign: f64| {
                    let mut at = point.at;
                    let [low, high] = chart.axes()[axis].range;
                    at[axis] = (at[axis] + sign * error).clamp(low, high);
                    chart.to_pixel(at)
                };
                bars.line(&[end(-1.0), end(1.0)]);
            }
        }
        series.marker.push(&mut marks, chart.to_pixel(point.at), MARK);
    }
    chart
        .svg
        .path(&bars, &format!(r#"fill="none" stroke="{}" stroke-width="1" opacity=".7""#, series.colour));
    chart.svg.path(&marks, &format!(r#"fill="{}""#, series.colour));
}
