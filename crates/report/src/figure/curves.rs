//! Curves against a common axis.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout};
use crate::colour::{BLUE, GREEN, GREY, VERMILLION};
use crate::key::KeyEntry;
use crate::svg::PathData;

/// Points up to which each gets a dot.
const MOST_DOTS: usize = 60;

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name for the key; empty for none. `_x` sets a subscript.
    pub label: String,
    /// Points in the order of the curve; those that cannot be shown on the axes break it.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub role: CurveRole,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveRole {
    /// Blue.
    First,
    /// Vermillion, dashed.
    Second,
    /// Green, dotted.
    Third,
    /// A thin grey line to compare with.
    Guide,
}

impl CurveRole {
    fn style(self) -> (String, &'static str) {
        let (colour, width, dashes) = match self {
            Self::First => (BLUE, 1.7, "none"),
            Self::Second => (VERMILLION, 1.7, "6 4"),
            Self::Third => (GREEN, 1.7, "2 3"),
            Self::Guide => (GREY, 1.1, "5 3"),
        };
        let style = format!(
            r#"stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}" stroke-linejoin="round""#
        );
        (style, colour)
    }
}

/// What a figure of curves says besides them.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveAxes<'a> {
    /// Heading, for screen readers.
    pub title: &'a str,
    /// Label of the horizontal axis with its unit, and its spread.
    pub x: (&'a str, AxisScale),
    /// The same of the vertical axis.
    pub y: (&'a str, AxisScale),
}

/// Curves with a key. Axes begin at zero where they are linear and all values are positive.
#[must_use]
pub fn curves(axes: &CurveAxes<'_>, curves: &[Curve]) -> String {
    let drawn = curves.iter().filter(|curve| curve.role != CurveRole::Guide);
    let all: Vec<[f64; 2]> = drawn.flat_map(|curve| curve.points.iter().copied()).collect();
    let axis = |(label, scale): (&str, AxisScale), which: usize| {
        range(all.iter().map(|point| point[which]), scale).map(|range| Axis {
            range,
            scale,
            ..Axis::linear(label, range)
        })
    };
    let (Some(x), Some(y)) = (axis(axes.x, 0), axis(axes.y, 1)) else {
        return no_data(axes.title);
    };
    let layout = ChartLayout { title: axes.title, size: [440.0, 290.0], left: 68.0, x, y };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(axes.title);
    };
    let mut key = Vec::new();
    for curve in curves {
        let (style, colour) = curve.role.style();
        let shown = |&point: &[f64; 2]| {
            let [x, y] = chart.axes();
            let fits = |axis: &Axis, value: f64| axis.scale == AxisScale::Linear || value > 0.0;
            if fits(x, point[0]) && fits(y, point[1]) { point } else { [f64::NAN; 2] }
        };
        let points: Vec<[f64; 2]> = curve.points.iter().map(shown).collect();
        chart.clipped_curve(&points, &style);
        if points.len() <= MOST_DOTS && curve.role != CurveRole::Guide {
            let mut dots = PathData::new();
            points
                .iter()
                .filter(|&&point| chart.contains(point))
                .for_each(|&point| dots.dot(chart.place(point)));
            let round = r#"fill="none" stroke-width="4" stroke-linecap="round""#;
            chart.svg.path(&dots, &format!(r#"stroke="{colour}" {round}"#));
        }
        if !curve.label.is_empty() {
            key.push(KeyEntry::line(&curve.label, &style));
        }
    }
    chart.frame();
    chart.finish_with_key(&key)
}

/// A range with some room around the values that the axis can show.
fn range(values: impl Iterator<Item = f64>, scale: AxisScale) -> Option<[f64; 2]> {
    let shown = values.filter(|&value| value.is_finite() && (scale == AxisScale::Linear || value > 0.0));
    let [low, high] =
        shown.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    if !low.is_finite() {
        return None;
    }
    Some(match scale {
        AxisScale::Logarithmic => {
            let room = (high / low).powf(0.06).max(1.3);
            [low / room, high * room]
        }
        AxisScale::Linear => {
            let low = low.min(0.0);
            let room = 0.05 * (high - low).max(1e-12 * high.abs()).max(1e-300);
            [if low < 0.0 { low - room } else { 0.0 }, high + room]
        }
    })
}
