//! Scatter of predicted against measured velocity components.

use super::{component_scatter, no_data};
use crate::chart::{Axis, Chart, ChartLayout};
use crate::numbers::{quantile, significant};
use crate::svg::{Anchor, TextStyle};
use crate::view::{FrameView, Units, is_finite};

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
    let outside = component_scatter::draw(&mut chart, [components(0).collect(), components(1).collect()]);
    annotate(&mut chart, nmse, outside);
    chart.finish()
}

fn annotate(chart: &mut Chart, nmse: f64, outside: usize) {
    let [_, [right, bottom]] = chart.plot();
    let text = format!("NMSE = {}", significant(nmse, 2));
    chart.svg.text([right - 10.0, bottom - 12.0], &text, TextStyle::label(Anchor::End));
    component_scatter::annotate(chart, outside, bottom - 28.0);
}
