//! What the base model leaves unexplained against what an effect predicts.

use super::{component_scatter, no_data};
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::INK;
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::numbers::{quantile, with_interval};
use crate::series::ErrorPoint;
use crate::svg::PathData;
use crate::units::Units;
use crate::view::is_finite;

/// Number of groups of equal size whose means are drawn.
const GROUPS: usize = 8;
/// Least number of components in a group.
const LEAST: usize = 12;
/// The line of the slope and the area of its interval.
const SLOPE: &str = r##"stroke="#222222" stroke-width="1.8""##;
const INTERVAL: &str = r##"fill="#222222" opacity=".16""##;
/// The line of equality.
const EQUAL: &str = r##"stroke="#666" stroke-width="1.2" stroke-dasharray="5 3""##;

/// One cell: both vectors with everything that the base model can explain projected out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartialPoint {
    /// What the effect predicts with its fitted coefficients.
    pub predicted: [f64; 2],
    /// The residual of the base model.
    pub residual: [f64; 2],
}

/// A partial regression plot of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct PartialRegression {
    /// Id of the effect.
    pub effect: String,
    /// One point per cell used.
    pub points: Vec<PartialPoint>,
    /// Slope of the residual over the prediction; one where the fitted coefficients are right.
    pub slope: f64,
    /// Its 95 % interval.
    pub slope_ci95: Option<[f64; 2]>,
}

/// Components of the residual against those that the effect predicts, with the fitted slope, its
/// interval as a wedge, and the means of groups of equal size. The axes cover 99.5 % of the
/// components; the number of points outside is stated.
#[must_use]
pub fn partial_regression(plot: &PartialRegression, units: &Units) -> String {
    let effect = plot.effect.replace('_', " ");
    let title = format!("partial regression of {effect}");
    let components = |axis: usize| -> Vec<[f64; 2]> {
        let points = plot.points.iter().map(move |point| [point.predicted[axis], point.residual[axis]]);
        points.filter(|&point| is_finite(point)).collect()
    };
    let components = [components(0), components(1)];
    let range = |side: usize| {
        let sizes = components.iter().flatten().map(|point| point[side].abs());
        quantile(sizes, 0.995).map(|reach| [-1.08 * reach, 1.08 * reach])
    };
    let [Some(across), Some(up)] = [range(0), range(1)] else {
        return no_data(&title);
    };
    let unit = units.velocity_text();
    let x = Axis::linear(&format!("{effect}, predicted ({unit})"), across);
    let y = Axis::linear(&format!("residual of the base model ({unit})"), up);
    let layout = ChartLayout { title: &title, size: [440.0, 400.0], left: 62.0, x, y };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(&title);
    };
    let bottom = chart.plot()[1][1];
    let groups = groups(components.concat());
    let outside = component_scatter::draw(&mut chart, components);
    let line = |slope: f64| across.map(|x| [x, slope * x]);
    let mut key = draw_slope(&mut chart, plot, across);
    chart.clipped_curve(&line(1.0), EQUAL);
    key.push(KeyEntry::line("slope 1", EQUAL));
    if !groups.is_empty() {
        let mean = |group: &Group| ErrorPoint { at: group.mean, error: [None, Some(group.error)] };
        chart.record("means of equal groups", groups.iter().map(mean));
        draw_groups(&mut chart, &groups);
        key.push(KeyEntry::new("means of equal groups ± standard error", |svg, middle| {
            let mut mark = PathData::new();
            Marker::Square.push(&mut mark, middle, 4.0);
            svg.path(&mark, GROUP);
        }));
    }
    component_scatter::annotate(&mut chart, outside, bottom - 12.0);
    chart.frame();
    chart.finish_with_key(&key)
}

/// A mark of a group.
const GROUP: &str = r##"fill="#fff" stroke="#222222" stroke-width="1.6""##;

/// The slope and its interval, where they are known; returns their entry of the key.
fn draw_slope(chart: &mut Chart, plot: &PartialRegression, [from, to]: [f64; 2]) -> Vec<KeyEntry> {
    if !plot.slope.is_finite() {
        return Vec::new();
    }
    let interval = plot.slope_ci95.filter(|&ends| is_finite(ends));
    let label = match interval {
        Some(ends) => {
            let [low, high] = chart.axes()[1].range;
            let mut wedges = PathData::new();
            for x in [from, to] {
                let places =
                    [[0.0, 0.0], [x, (ends[0] * x).clamp(low, high)], [x, (ends[1] * x).clamp(low, high)]];
                wedges.polygon(&places.map(|at| chart.to_pixel(at)));
            }
            chart.svg.path(&wedges, INTERVAL);
            let [slope, low, high] = with_interval(plot.slope, ends);
            format!("slope {slope} (95 %: {low} to {high})")
        }
        None => format!("slope {}", crate::numbers::significant(plot.slope, 2)),
    };
    chart.clipped_curve(&[from, to].map(|x| [x, plot.slope * x]), SLOPE);
    vec![KeyEntry::line(&label, SLOPE)]
}

/// Mean of a group of points and the standard error of its height.
struct Group {
    mean: [f64; 2],
    error: f64,
}

/// The means of groups of equal size by increasing prediction; none where points are few.
fn groups(mut points: Vec<[f64; 2]>) -> Vec<Group> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let size = points.len() / GROUPS;
    if size < LEAST {
        return Vec::new();
    }
    let group = |points: &[[f64; 2]]| {
        let count = points.len() as f64;
        let mean = [0, 1].map(|side| points.iter().map(|point| point[side]).sum::<f64>() / count);
        let square: f64 = points.iter().map(|point| (point[1] - mean[1]).powi(2)).sum();
        Group { mean, error: (square / (count - 1.0) / count).sqrt() }
    };
    points.chunks(points.len().div_ceil(GROUPS)).filter(|part| part.len() >= LEAST).map(group).collect()
}

fn draw_groups(chart: &mut Chart, groups: &[Group]) {
    let [mut bars, mut marks] = [PathData::new(), PathData::new()];
    for Group { mean: [x, y], error } in groups {
        if chart.contains([*x, *y]) {
            bars.line(&[[*x, y - error], [*x, y + error]].map(|at| chart.to_pixel(at)));
            Marker::Square.push(&mut marks, chart.to_pixel([*x, *y]), 4.0);
        }
    }
    chart.svg.path(&bars, &format!(r#"fill="none" stroke="{INK}" stroke-width="1.6""#));
    chart.svg.path(&marks, GROUP);
}
