//! Scatter of predicted against measured velocity components.

use super::flow_map::FlowMap;
use super::{component_scatter, no_data};
use crate::chart::{Axis, Chart, ChartLayout};
use crate::numbers::{quantile, significant};
use crate::svg::{Anchor, TextStyle};
use crate::units::Units;
use crate::view::{CellView, FrameView, is_finite};

/// One cell's measured and predicted velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityPair {
    /// As measured.
    pub measured: [f64; 2],
    /// As the model gives it.
    pub predicted: [f64; 2],
}

/// Which predictions are compared with what was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prediction {
    /// By fits that did not see the velocity, at the measured positions.
    HeldOut,
    /// By the fit itself, at the nudged positions.
    Fitted,
}

impl Prediction {
    /// The pairs of the used cells of some frames.
    #[must_use]
    pub fn of_cells(self, frames: &[FrameView]) -> Vec<VelocityPair> {
        let cells = frames.iter().flat_map(|frame| &frame.cells).filter(|cell| cell.is_used());
        let pair = |cell: &CellView| {
            let predicted = match self {
                Self::HeldOut => cell.held_out,
                Self::Fitted => cell.predicted,
            };
            Some(VelocityPair { measured: cell.measured?, predicted: predicted? })
        };
        cells.filter_map(pair).collect()
    }

    /// The pairs of the grid points of some flows.
    #[must_use]
    pub fn on_grid(self, flows: &[FlowMap<'_>]) -> Vec<VelocityPair> {
        let of_flow = |flow: &FlowMap<'_>| -> Vec<VelocityPair> {
            let predicted = match self {
                Self::HeldOut => &flow.held_out,
                Self::Fitted => &flow.predicted,
            };
            let both = flow.measured.iter().zip(predicted);
            let pair = |(measured, predicted): (&Option<_>, &Option<_>)| {
                Some(VelocityPair { measured: (*measured)?, predicted: (*predicted)? })
            };
            both.filter_map(pair).collect()
        };
        flows.iter().flat_map(of_flow).collect()
    }
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
