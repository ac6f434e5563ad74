//! Eigenvalues in the complex plane.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, INK, VERMILLION};
use crate::key::KeyEntry;
use crate::numbers::quantile;
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::label_with_unit;

/// Modes in which fewer than this share of the cells take part are drawn as localised.
const LOCALISED: f64 = 0.1;
/// Marks are drawn in this many translucent layers, so that dense regions look dense.
const LAYERS: usize = 24;

/// An eigenvalue as the figures show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumPoint {
    /// Rate of growth.
    pub rate: f64,
    /// Angular frequency.
    pub frequency: f64,
    /// Share of the cells that take part, where it is known.
    pub participation: Option<f64>,
}

/// Frequency against rate of growth. Modes of few cells are diamonds. The axes leave out the farthest percent of the modes,
/// but none that grow; their number is stated.
#[must_use]
pub fn complex_spectrum(points: &[SpectrumPoint], unit: &str) -> String {
    let title = "eigenvalues of the Jacobian";
    let sound = |point: &&SpectrumPoint| point.rate.is_finite() && point.frequency.is_finite();
    let points: Vec<&SpectrumPoint> = points.iter().filter(sound).collect();
    let Some(ranges) = ranges(&points) else {
        return no_data(title);
    };
    let layout = ChartLayout {
        title,
        size: [520.0, 380.0],
        left: 66.0,
        x: Axis::linear(&label_with_unit("rate of growth, Re λ", unit), ranges[0]),
        y: Axis::linear(&label_with_unit("angular frequency, Im λ", unit), ranges[1]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    let axis = format!(r#"stroke="{INK}" stroke-width=".9" stroke-dasharray="3 3""#);
    for line in [[[0.0, ranges[1][0]], [0.0, ranges[1][1]]], [[ranges[0][0], 0.0], [ranges[0][1], 0.0]]] {
        if line.iter().all(|&end| chart.contains(end)) {
            chart.curve(&line, &axis);
        }
    }
    chart.record("modes", points.iter().map(|point| [point.rate, point.frequency]));
    let outside = draw_points(&mut chart, &points);
    if outside > 0 {
        let [[left, top], _] = chart.plot();
        let text = format!("{outside} outside the axes");
        chart.svg.text_with_rim([left + 8.0, top + 15.0], &text, TextStyle::quiet(Anchor::Start), "#fff");
    }
    chart.frame();
    let known = points.iter().any(|point| point.participation.is_some());
    let entry = |label: &str, few: bool| KeyEntry::new(label, |svg, at| mark(svg, few, &[at], "1"));
    let entries =
        [entry("at least a tenth of the cells take part", false), entry("fewer: a localised mode", true)];
    chart.finish_with_key(if known { &entries } else { &[] })
}

fn ranges(points: &[&SpectrumPoint]) -> Option<[[f64; 2]; 2]> {
    let rates = || points.iter().map(|point| point.rate);
    let frequencies = || points.iter().map(|point| point.frequency.abs());
    let few = points.len() < 100;
    let low = quantile(rates(), if few { 0.0 } else { 0.01 })?.min(0.0);
    let high = rates().fold(0.0, f64::max);
    let top = quantile(frequencies(), if few { 1.0 } else { 0.995 })?;
    let width = (high - low).max(1e-9);
    // A spectrum without waves still gets a plane to lie in.
    let top = if top > 1e-6 * width { 1.08 * top } else { 0.1 * width };
    Some([[low - 0.05 * width, high + 0.05 * width], [-top, top]])
}

/// Draws the points; returns how many lie outside.
fn draw_points(chart: &mut Chart, points: &[&SpectrumPoint]) -> usize {
    let mut layers = vec![[Vec::new(), Vec::new()]; LAYERS];
    let mut outside = 0;
    for (index, point) in points.iter().enumerate() {
        let at = [point.rate, point.frequency];
        if chart.contains(at) {
            let few = point.participation.is_some_and(|share| share < LOCALISED);
            layers[index % LAYERS][usize::from(few)].push(chart.to_pixel(at));
        } else {
            outside += 1;
        }
    }
    let opacity = if points.len() > 300 { ".5" } else { ".85" };
    for [many, few] in &layers {
        mark(&mut chart.svg, false, many, opacity);
        mark(&mut chart.svg, true, few, opacity);
    }
    outside
}

fn mark(svg: &mut Svg, few: bool, places: &[[f64; 2]], opacity: &str) {
    let mut path = PathData::new();
    for &[x, y] in places {
        if few {
            path.polygon(&[[x - 2.6, y], [x, y - 2.6], [x + 2.6, y], [x, y + 2.6]]);
        } else {
            path.dot([x, y]);
        }
    }
    let style = if few {
        format!(r#"fill="{VERMILLION}" opacity="{opacity}""#)
    } else {
        format!(r#"fill="none" stroke="{BLUE}" stroke-width="4" stroke-linecap="round" opacity="{opacity}""#)
    };
    svg.path(&path, &style);
}
