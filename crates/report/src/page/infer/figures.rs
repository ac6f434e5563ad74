//! The figures of the page.

use super::super::words::POLARITIES;
use super::super::{Figure, Panel};
use super::InferPage;
use crate::arrows::ArrowScale;
use crate::figure::{
    CellScalar, Emphasis, ErrorBar, FlowMap, NudgeHistogram, ObjectiveTrace, Prediction, VelocityField,
    cell_map, error_bars, flow_map, nudge_histogram, nudge_map, objective_trace, polarity_map,
    predicted_against_measured, velocity_map,
};
use crate::infer_report::InferReport;
use crate::many_cells::{Squares, middle};
use crate::map::MOST_DRAWN;
use crate::numbers::significant;
use crate::view::FrameView;

impl InferPage<'_> {
    pub(super) fn error_figure(&self) -> Figure {
        let advice = match self.report.nmse.cross_validated {
            Some(_) => "Quote the cross-validated number: it is for cells that the fit has not seen.",
            None => {
                "The number at nudged positions is too good: the nudges were chosen with these \
                 velocities."
            }
        };
        let caption =
            format!("Share of the squared velocities that each prediction leaves unexplained. {advice}");
        Figure::new(error_bars(&bars(self.report)), &caption)
    }

    pub(super) fn trace_figure(&self) -> Figure {
        let fit = &self.report.fit;
        let trace = ObjectiveTrace { values: &fit.trace, expected: Some(fit.expected_objective) };
        Figure::new(
            objective_trace(&trace),
            "Course of the fit. An end far above the expected value means that the fit is stuck \
             or that the model does not describe the data.",
        )
    }

    pub(super) fn scatter_figure(&self) -> Figure {
        let report = self.report;
        let (prediction, nmse, how) = match report.nmse.cross_validated {
            Some(nmse) => (
                Prediction::HeldOut,
                nmse,
                "predicted by fits that did not see its velocity, at measured positions",
            ),
            None => (
                Prediction::Fitted,
                report.nmse.nudged,
                "after the fit, at nudged positions: too good to be true",
            ),
        };
        let (mut pairs, what) = match report.flow {
            None => (prediction.of_cells(self.frames), "cell"),
            Some(_) => (prediction.on_grid(self.flows), "grid point"),
        };
        let one_of = pairs.len().div_ceil(MOST_DRAWN).max(1);
        pairs = pairs.into_iter().step_by(one_of).collect();
        let which = if one_of == 1 { format!("Every {what}") } else { format!("One in {one_of} {what}s") };
        let caption = format!(
            "{which} used in the frames drawn, {how}. On the dashed line a prediction is perfect; the error \
             written is that of all frames."
        );
        Figure::new(predicted_against_measured(&pairs, nmse, &report.units), &caption)
    }

    pub(super) fn nudge_figure(&self) -> Figure {
        let (length, noise) = (self.report.length_scale.value, self.report.noise.sigma_r);
        Figure::new(
            nudge_histogram(&NudgeHistogram::new(self.frames, length, noise / length)),
            "Sizes of the nudges of the cells used, and the distribution of the assumed \
             position noise. Nudges are usually smaller than the noise, because the data \
             determine only part of it.",
        )
    }

    /// Maps of each frame that is drawn.
    pub(super) fn panels(&self) -> Vec<Panel> {
        let units = &self.report.units;
        let on_grid = !self.flows.is_empty();
        let (drawn, squares): (Vec<FrameView>, Vec<Squares>) = self.frames.iter().map(Squares::of).unzip();
        let (velocities, residuals) = match on_grid {
            true => (FlowMap::scale(self.flows), FlowMap::residual_scale(self.flows.iter())),
            false => (ArrowScale::velocities(&drawn), ArrowScale::residuals(&drawn)),
        };
        let middle: Vec<FrameView> = self.frames.iter().map(middle).collect();
        let nudges = ArrowScale::nudges(&middle);
        let panel = |(index, whole): (usize, &FrameView)| {
            let (frame, squares) = (&drawn[index], &squares[index]);
            let map = |scalar: CellScalar, caption: &str| {
                Figure::new(cell_map(frame, &squares.means(scalar), units), &squares.caption(caption))
            };
            let is_part = middle[index].cells.len() < whole.cells.len();
            let part = if is_part { ", of cells in the middle" } else { "" };
            let velocity = |field: VelocityField| {
                let scale = match field {
                    VelocityField::Residual => residuals.as_ref(),
                    VelocityField::Measured | VelocityField::Predicted => velocities.as_ref(),
                };
                let map = match self.flows.get(index) {
                    Some(flow) => flow_map(flow, field, scale, units),
                    None => velocity_map(frame, field, scale, units),
                };
                let caption = caption(field, [&velocities, &residuals]);
                Figure::new(map, &if on_grid { caption } else { squares.caption(&caption) })
            };
            let mut figures: Vec<Figure> = VelocityField::ALL.map(velocity).into();
            if self.report.activity.is_some() {
                let map = polarity_map(frame, velocities.as_ref(), units);
                figures.push(Figure::new(map, &squares.caption(POLARITIES)));
            }
            let spreads = self.spreads.iter();
            figures.extend(spreads.map(|spread| spread.drawn_on((frame, squares), index, units)));
            let nudges = nudge_map(&middle[index], nudges.as_ref(), units);
            figures.extend([
                Figure::new(nudges, &format!("nudges, magnified as stated{part}")),
                map(CellScalar::area_ratio(whole), "cell areas"),
                map(CellScalar::shape_index(whole), "cell shapes (hexagon: 3.72)"),
            ]);
            Panel::new(&whole.label, whole.cells.len(), figures)
        };
        self.frames.iter().enumerate().map(panel).collect()
    }
}

/// The caption of a map of velocities; that of residuals says how much longer their arrows are drawn than the others.
fn caption(field: VelocityField, [velocities, residuals]: [&Option<ArrowScale>; 2]) -> String {
    let ratio = match (field, velocities, residuals) {
        (VelocityField::Residual, Some(velocities), Some(residuals)) => {
            residuals.stretch / velocities.stretch
        }
        _ => return field.caption().to_owned(),
    };
    format!("residual, arrows drawn {}× longer", significant(ratio, 2))
}

fn bars(report: &InferReport) -> Vec<ErrorBar> {
    let nmse = &report.nmse;
    let main = if nmse.cross_validated.is_some() { Emphasis::Quiet } else { Emphasis::Main };
    let bar = |label: &str, nmse: f64, emphasis: Emphasis| ErrorBar {
        label: label.to_owned(),
        nmse,
        standard_error: None,
        emphasis,
    };
    let mut bars = vec![
        bar("naive fit", nmse.naive, Emphasis::Quiet),
        bar("nudged, at measured r", nmse.un_nudged, main),
        bar("nudged, at nudged r", nmse.nudged, Emphasis::Quiet),
        bar("noise alone", nmse.noise_floor, Emphasis::Quiet),
    ];
    if let Some(error) = nmse.cross_validated {
        bars.push(ErrorBar {
            standard_error: nmse.cross_validated_standard_error,
            ..bar("cross-validated", error, Emphasis::Main)
        });
    }
    bars
}
