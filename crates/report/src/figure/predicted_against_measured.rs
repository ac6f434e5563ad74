//! Scatter of predicted against measured velocity components.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, VERMILLION};
use crate::numbers::{quantile, significant};
use crate::svg::{Anchor, PathData, TextStyle};
use crate::view::{FrameView, Units, is_finite};

/// Marks are drawn in this many translucent layers, so that dense regions look dense.
const LAYERS: usize = 24;
/// Half the size of a mark in pixels.
const MARK: f64 = 1.9;

/// One cell's measured and predicted velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityPair {
    /// As measured.
    pub measured: [f64; 2],
    /// As the model gives it.
    pub predicted: [f64; 2],
}

/// The pairs of the used cells of some frames.
#[must_use]
pub fn velocity_pairs(frames: &[FrameView]) -> Vec<VelocityPair> {
    let cells = frames.iter().flat_map(|frame| &frame.cells).filter(|cell| cell.is_used());
    cells
        .filter_map(|cell| Some(VelocityPair { measured: cell.measured?, predicted: cell.predicted? }))
        .collect()
}

/// Predicted against measured velocity components (x: blue dots, y: orange diamonds), with the line
/// of perfect prediction and the given NMSE. The axes cover 99.5 % of the components; the number of
/// points outside is stated.
#[must_use]
pub fn predicted_against_measured(pairs: &[VelocityPair], nmse: f64, units: &Units) -> String {
    let title = "predicted against measured velocities";
    let components = |axis: usize| {
        pairs
            .iter()
            .map(move |pair| [pair.measured[axis], pair.predicted[axis]])
            .filter(|&point| is_finite(point))
    };
    let sizes = components(0).chain(components(1)).map(|[a, b]| a.abs().max(b.abs()));
    let Some(reach) = quantile(sizes, 0.995).filter(|&reach| reach > 0.0) else {
        return no_data(title);
    };
    let range = [-1.08 * reach, 1.08 * reach];
    let unit = units.velocity_text();
    let x = Axis::linear(&format!("measured velocity ({unit})"), range);
    let y = Axis::linear(&format!("predicted velocity ({unit})"), range);
    let layout = ChartLayout { title, size: [440.0, 430.0], left: 62.0, x, y };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    chart.curve(&[[range[0]; 2], [range[1]; 2]], r##"stroke="#666" stroke-dasharray="5 3""##);
    let outside = draw_marks(&mut chart, [components(0).collect(), components(1).collect()]);
    annotate(&mut chart, nmse, outside);
    chart.finish()
}

/// Draws the marks layer by layer; returns how many lie outside the axes.
fn draw_marks(chart: &mut Chart, components: [Vec<[f64; 2]>; 2]) -> usize {
    let mut layers = vec![[PathData::new(), PathData::new()]; LAYERS];
    let mut outside = 0;
    for (axis, points) in components.iter().enumerate() {
        for (index, &point) in points.iter().enumerate() {
            if !chart.contains(point) {
                outside += 1;
                continue;
            }
            let path = &mut layers[index % LAYERS][axis];
            push_mark(path, axis, chart.place(point));
        }
    }
    for [dots, diamonds] in &layers {
        chart.svg.path(dots, &mark_style(0));
        chart.svg.path(diamonds, &mark_style(1));
    }
    outside
}

fn push_mark(path: &mut PathData, axis: usize, at: [f64; 2]) {
    let [x, y] = at;
    if axis == 0 {
        path.dot(at);
    } else {
        let size = 1.2 * MARK;
        path.polygon(&[[x - size, y], [x, y - size], [x + size, y], [x, y + size]]);
    }
}

fn mark_style(axis: usize) -> String {
    if axis == 0 {
        let width = 2.0 * MARK;
        format!(r#"fill="none" stroke="{BLUE}" stroke-width="{width}" stroke-linecap="round" opacity=".5""#)
    } else {
        format!(r#"fill="{VERMILLION}" opacity=".5""#)
    }
}

fn annotate(chart: &mut Chart, nmse: f64, outside: usize) {
    let [[left, top], [right, bottom]] = chart.plot();
    for (axis, label) in ["x component", "y component"].into_iter().enumerate() {
        let y = top + 16.0 + 16.0 * axis as f64;
        let mut mark = PathData::new();
        push_mark(&mut mark, axis, [left + 14.0, y - 4.0]);
        chart.svg.path(&mark, &mark_style(axis));
        chart.svg.text([left + 24.0, y], label, TextStyle::label(Anchor::Start));
    }
    let text = format!("NMSE = {}", significant(nmse, 2));
    chart.svg.text([right - 10.0, bottom - 12.0], &text, TextStyle::label(Anchor::End));
    if outside > 0 {
        let text = format!("{outside} points outside the axes");
        chart.svg.text([right - 10.0, bottom - 28.0], &text, TextStyle::quiet(Anchor::End));
    }
}
