//! The page of the command `infer`.

use serde::Serialize;

use super::parameter_table::{TableRow, parameter_rows};
use super::uncertainty::{Known, Uncertainty};
use super::words::{data, fit_status, mean_removed, noise_source, warnings};
use super::{Card, Columns, Figure, PageHead, Panel, Template, render};
use crate::arrows::ArrowScale;
use crate::error::ReportError;
use crate::figure::{
    CellScalar, Emphasis, ErrorBar, FlowMap, NudgeHistogram, ObjectiveTrace, ParameterRow, VelocityField,
    VelocityPair, cell_map, error_bars, flow_map, nudge_histogram, nudge_map, objective_trace,
    predicted_against_measured, velocity_map, velocity_pairs,
};
use crate::infer_report::InferReport;
use crate::numbers::{NO_VALUE, significant};
use crate::view::FrameView;

const TEMPLATE: Template =
    Template { name: "infer.html", source: include_str!("../../templates/infer.html") };

/// Everything the page of `infer` shows.
#[derive(Debug, Clone, Copy)]
pub struct InferPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// What `report.json` holds.
    pub report: &'a InferReport,
    /// The frames to draw; each adds about 0.5 kB per cell to the page.
    pub frames: &'a [FrameView],
    /// Their velocities, one map for each frame, where these are on a grid; empty otherwise.
    pub flows: &'a [FlowMap<'a>],
    /// What was asked beyond the fit.
    pub uncertainty: &'a Uncertainty,
}

impl InferPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let report = self.report;
        let rows = parameter_rows(&report.parameters, Some(&report.naive));
        let head = PageHead {
            title: self.title,
            headline: self.headline,
            summary: self.summary,
            doubts: &report.fit.doubts,
            warnings: warnings(&report.run, &report.fit.doubts),
            cards: cards(report, &rows),
            run: &report.run,
        };
        let context = Context {
            head,
            report,
            mean_removed: mean_removed(report.nmse.mean_removed),
            noise_source: noise_source(report.noise.source),
            fit_status: fit_status(report.fit.status),
            velocity_unit: report.units.velocity_text(),
            data: data(report.flow.as_ref()),
            known: Known::new(report, &rows, self.uncertainty),
            parameters: rows.iter().map(TableRow::new).collect(),
            error_figure: self.error_figure(),
            trace_figure: self.trace_figure(),
            scatter_figure: self.scatter_figure(),
            nudge_figure: Figure::new(
                nudge_histogram(&NudgeHistogram::new(
                    self.frames,
                    report.length_scale.value,
                    report.noise.sigma_r / report.length_scale.value,
                )),
                "Sizes of the nudges of the cells used, and the distribution of the assumed \
                 position noise. Nudges are usually smaller than the noise, because the data \
                 determine only part of it.",
            ),
            panels: self.panels(),
        };
        render(TEMPLATE, &context)
    }

    fn error_figure(&self) -> Figure {
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

    fn trace_figure(&self) -> Figure {
        let fit = &self.report.fit;
        let trace = ObjectiveTrace { values: &fit.trace, expected: Some(fit.expected_objective) };
        Figure::new(
            objective_trace(&trace),
            "Course of the fit. An end far above the expected value means that the fit is stuck \
             or that the model does not describe the data.",
        )
    }

    fn scatter_figure(&self) -> Figure {
        let report = self.report;
        let pairs = match report.flow {
            None => velocity_pairs(self.frames),
            Some(_) => self.flows.iter().flat_map(flow_pairs).collect(),
        };
        let what = if report.flow.is_some() { "grid point" } else { "cell" };
        let caption = format!(
            "Every {what} used in the frames drawn, after the fit (at nudged positions); on the dashed line a \
             prediction is perfect."
        );
        Figure::new(predicted_against_measured(&pairs, report.nmse.nudged, &report.units), &caption)
    }

    fn panels(&self) -> Vec<Panel> {
        let units = &self.report.units;
        let velocities = ArrowScale::velocities(self.frames);
        let flow_scale = FlowMap::scale(self.flows);
        let nudges = ArrowScale::nudges(self.frames);
        let panel = |(index, frame): (usize, &FrameView)| {
            let area = CellScalar::area_ratio(frame);
            let shape = CellScalar::shape_index(frame);
            let velocity = |field: VelocityField| {
                let map = match self.flows.get(index) {
                    Some(flow) => flow_map(flow, field, flow_scale.as_ref(), units),
                    None => velocity_map(frame, field, velocities.as_ref(), units),
                };
                Figure::new(map, field.caption())
            };
            let mut figures: Vec<Figure> = VelocityField::ALL.map(velocity).into();
            figures.extend([
                Figure::new(nudge_map(frame, nudges.as_ref(), units), "nudges, magnified as stated"),
                Figure::new(cell_map(frame, &area, units), "cell areas"),
                Figure::new(cell_map(frame, &shape, units), "cell shapes (3.72 is a regular hexagon)"),
            ]);
            Panel { label: frame.label.clone(), figures, columns: Columns::for_cells(frame.cells.len()) }
        };
        self.frames.iter().enumerate().map(panel).collect()
    }
}

#[derive(Serialize)]
struct Context<'a> {
    head: PageHead<'a>,
    report: &'a InferReport,
    mean_removed: &'static str,
    noise_source: &'static str,
    fit_status: &'static str,
    velocity_unit: String,
    data: &'static str,
    known: Known,
    parameters: Vec<TableRow>,
    error_figure: Figure,
    trace_figure: Figure,
    scatter_figure: Figure,
    nudge_figure: Figure,
    panels: Vec<Panel>,
}

/// The grid points with a measured and a predicted velocity.
fn flow_pairs(flow: &FlowMap<'_>) -> Vec<VelocityPair> {
    let both = flow.measured.iter().zip(&flow.predicted);
    both.filter_map(|(measured, predicted)| {
        Some(VelocityPair { measured: (*measured)?, predicted: (*predicted)? })
    })
    .collect()
}

fn cards(report: &InferReport, rows: &[ParameterRow]) -> Vec<Card> {
    let parameter = |row: &ParameterRow| {
        let table = TableRow::new(row);
        Card {
            label: row.symbol.clone(),
            value: if row.value.is_finite() {
                format!("{} {}", table.value, table.unit).trim_end().to_owned()
            } else {
                NO_VALUE.to_owned()
            },
            note: match row.interval() {
                Some(_) => format!("95 %: {}", table.interval),
                None => table.interval,
            },
        }
    };
    let mut cards: Vec<Card> = rows.iter().take(3).map(parameter).collect();
    let (nmse, note) = match report.nmse.cross_validated {
        Some(nmse) => (nmse, "cross-validated; 1 predicts nothing"),
        None => (report.nmse.un_nudged, "at measured positions; 1 predicts nothing"),
    };
    cards.push(Card { label: "NMSE".into(), value: significant(nmse, 2), note: note.into() });
    cards.push(Card {
        label: data(report.flow.as_ref()).into(),
        value: report.cells.used.to_string(),
        note: format!(
            "used in {}; {} left out",
            frames_text(report.cells.frames.len()),
            report.cells.left_out.values().sum::<usize>()
        ),
    });
    cards
}

fn frames_text(count: usize) -> String {
    if count == 1 { "1 frame".to_owned() } else { format!("{count} frames") }
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
