//! The page of the command `infer`.

use serde::Serialize;

use super::{Card, Figure, PageHead, Panel, Template, render};
use crate::arrows::ArrowScale;
use crate::colour::diverging;
use crate::error::ReportError;
use crate::figure::{
    CellScalar, Emphasis, ErrorBar, Estimate, NudgeHistogram, ObjectiveTrace, ParameterRow,
    VelocityField, cell_map, error_bars, nudge_histogram, nudge_map, objective_trace,
    parameter_intervals, predicted_against_measured, velocity_map, velocity_pairs,
};
use crate::infer_report::{FitStatus, InferReport, MeanRemoved, NoiseSource, Parameter};
use crate::numbers::{NO_VALUE, significant, unit_text, with_interval};
use crate::view::FrameView;

const TEMPLATE: Template = Template {
    name: "infer.html",
    source: include_str!("../../templates/infer.html"),
};

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
    /// The frames to draw; each adds about 0.3 kB per cell to the page.
    pub frames: &'a [FrameView],
}

impl InferPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let report = self.report;
        let rows = parameter_rows(report);
        let head = PageHead {
            title: self.title,
            headline: self.headline,
            summary: self.summary,
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
            intervals: Figure::new(
                parameter_intervals(&rows),
                "Each parameter on its own axis; the dashed upright line is zero.",
            ),
            parameters: rows.iter().map(TableRow::new).collect(),
            fit_figures: self.fit_figures(),
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
            directions: directions(report),
            panels: self.panels(),
        };
        render(TEMPLATE, &context)
    }

    fn fit_figures(&self) -> Vec<Figure> {
        let report = self.report;
        let trace = ObjectiveTrace {
            values: &report.fit.trace,
            expected: Some(report.fit.expected_objective),
        };
        let pairs = velocity_pairs(self.frames);
        vec![
            Figure::new(
                error_bars(&bars(report)),
                "Share of the squared velocities that each prediction leaves unexplained. Quote \
                 the cross-validated number: it is the one for cells the fit has not seen.",
            ),
            Figure::new(
                predicted_against_measured(&pairs, report.nmse.nudged, &report.units),
                "Every cell used in the frames drawn, after the fit; on the dashed line a \
                 prediction is perfect.",
            ),
            Figure::new(
                objective_trace(&trace),
                "Course of the fit. An end far above the expected value means that the fit is \
                 stuck or the model does not describe the data.",
            ),
        ]
    }

    fn panels(&self) -> Vec<Panel> {
        let units = &self.report.units;
        let velocities = ArrowScale::velocities(self.frames);
        let nudges = ArrowScale::nudges(self.frames);
        let panel = |frame: &FrameView| {
            let area = CellScalar::area_ratio(frame);
            let shape = CellScalar::shape_index(frame);
            let fields = VelocityField::ALL.map(|field| {
                let svg = velocity_map(frame, field, velocities.as_ref(), units);
                Figure::new(svg, field.caption())
            });
            let state = vec![
                Figure::new(cell_map(frame, &area, units), "cell areas"),
                Figure::new(
                    cell_map(frame, &shape, units),
                    "cell shapes (3.72 is a regular hexagon)",
                ),
                Figure::new(
                    nudge_map(frame, nudges.as_ref(), units),
                    "nudges, magnified as stated",
                ),
            ];
            Panel {
                label: frame.label.clone(),
                rows: vec![fields.into(), state],
            }
        };
        self.frames.iter().map(panel).collect()
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
    intervals: Figure,
    parameters: Vec<TableRow>,
    fit_figures: Vec<Figure>,
    nudge_figure: Figure,
    directions: Directions,
    panels: Vec<Panel>,
}

/// A parameter as the table shows it.
#[derive(Serialize)]
struct TableRow {
    symbol: String,
    meaning: String,
    unit: String,
    value: String,
    interval: String,
    naive: String,
}

impl TableRow {
    fn new(row: &ParameterRow) -> Self {
        let [value, low, high] =
            with_interval(row.value, row.interval().unwrap_or([row.value, row.value]));
        let interval = match (row.interval(), row.estimate) {
            (Some(_), _) => format!("{low} to {high}"),
            (None, Estimate::Fixed) => "held fixed".to_owned(),
            (None, Estimate::Fitted) => "not determined".to_owned(),
        };
        Self {
            symbol: row.symbol.clone(),
            meaning: row.meaning.clone(),
            unit: unit_text(&row.unit),
            value,
            interval,
            naive: row
                .naive
                .map_or_else(|| NO_VALUE.to_owned(), |naive| significant(naive, 3)),
        }
    }
}

/// The table of eigenvalues: one column per parameter, tinted by the component.
#[derive(Serialize)]
struct Directions {
    names: Vec<String>,
    rows: Vec<DirectionRow>,
}

#[derive(Serialize)]
struct DirectionRow {
    eigenvalue: f64,
    cells: Vec<DirectionCell>,
}

#[derive(Serialize)]
struct DirectionCell {
    text: String,
    colour: String,
}

fn directions(report: &InferReport) -> Directions {
    let mut names: Vec<&String> = report
        .identifiability
        .iter()
        .flat_map(|mode| mode.direction.keys())
        .collect();
    names.sort();
    names.dedup();
    let cell = |component: Option<&f64>| {
        let component = component.copied().filter(|value| value.is_finite());
        // Half strength keeps the text legible on the tint.
        let tint = diverging(0.5 + 0.28 * component.unwrap_or(0.0).clamp(-1.0, 1.0));
        let [red, green, blue] = tint;
        let size = component.unwrap_or(0.0).abs();
        DirectionCell {
            text: component.map_or_else(
                || NO_VALUE.to_owned(),
                |value| format!("{value:.2}").replace('-', "−"),
            ),
            colour: if size < 0.1 {
                "#fff".into()
            } else {
                format!("#{red:02x}{green:02x}{blue:02x}")
            },
        }
    };
    let rows = report.identifiability.iter().map(|mode| DirectionRow {
        eigenvalue: mode.eigenvalue,
        cells: names
            .iter()
            .map(|name| cell(mode.direction.get(*name)))
            .collect(),
    });
    Directions {
        rows: rows.collect(),
        names: names.iter().map(|name| symbol_of(name)).collect(),
    }
}

/// The printed symbol of a parameter's name in the file.
fn symbol_of(name: &str) -> String {
    match name {
        "alpha" => "α".to_owned(),
        "K_P_alpha" => "K_P α".to_owned(),
        "K_P_P_0" => "K_P P_0".to_owned(),
        "shape_index" => "P_0/ℓ_0".to_owned(),
        other => other.to_owned(),
    }
}

/// The rows of the parameter table, the best determined first.
fn parameter_rows(report: &InferReport) -> Vec<ParameterRow> {
    let (fitted, naive) = (&report.parameters, &report.naive);
    let row = |name: &str, parameter: &Parameter, naive: f64, meaning: &str| ParameterRow {
        symbol: symbol_of(name),
        unit: parameter.unit.clone(),
        value: parameter.value,
        ci95: parameter.ci95,
        naive: Some(naive).filter(|naive| naive.is_finite()),
        estimate: if parameter.fixed {
            Estimate::Fixed
        } else {
            Estimate::Fitted
        },
        meaning: meaning.to_owned(),
    };
    vec![
        row(
            "K_P_alpha",
            &fitted.K_P_alpha,
            naive.K_P_alpha,
            "chiral rate: how fast cells turn around each other; positive is counter-clockwise \
             (y axis up)",
        ),
        row(
            "shape_index",
            &fitted.shape_index,
            naive.shape_index,
            "preferred shape: small is round and rigid, above about 3.8 elongated and fluid \
             (without chirality)",
        ),
        row(
            "alpha",
            &fitted.alpha,
            naive.alpha,
            "chirality: part of the perimeter force that is turned by 90°",
        ),
        row(
            "K_P",
            &fitted.K_P,
            naive.K_P,
            "stiffness of the cell outline",
        ),
        row(
            "P_0",
            &fitted.P_0,
            naive.P_0,
            "preferred length of the cell outline",
        ),
        row(
            "K_A",
            &fitted.K_A,
            naive.K_A,
            "stiffness of the cell area; often not determined",
        ),
    ]
}

fn cards(report: &InferReport, rows: &[ParameterRow]) -> Vec<Card> {
    let parameter = |row: &ParameterRow| {
        let table = TableRow::new(row);
        Card {
            label: row.symbol.clone(),
            value: format!("{} {}", table.value, table.unit)
                .trim_end()
                .to_owned(),
            note: match row.interval() {
                Some(_) => format!("95 %: {}", table.interval),
                None => table.interval,
            },
        }
    };
    let mut cards: Vec<Card> = rows.iter().take(3).map(parameter).collect();
    let (nmse, note) = match report.nmse.cross_validated {
        Some(nmse) => (nmse, "cross-validated; 1 predicts nothing"),
        None => (
            report.nmse.un_nudged,
            "at measured positions; 1 predicts nothing",
        ),
    };
    cards.push(Card {
        label: "NMSE".into(),
        value: significant(nmse, 2),
        note: note.into(),
    });
    cards.push(Card {
        label: "cells".into(),
        value: report.cells.used.to_string(),
        note: format!(
            "used; {} left out; frames: {}",
            report.cells.left_out.values().sum::<usize>(),
            report.cells.frames.len()
        ),
    });
    cards
}

fn bars(report: &InferReport) -> Vec<ErrorBar> {
    let nmse = &report.nmse;
    let main = if nmse.cross_validated.is_some() {
        Emphasis::Quiet
    } else {
        Emphasis::Main
    };
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
    ];
    if let Some(error) = nmse.cross_validated {
        bars.push(ErrorBar {
            standard_error: nmse.cross_validated_standard_error,
            ..bar("cross-validated", error, Emphasis::Main)
        });
    }
    bars
}

fn mean_removed(mean: MeanRemoved) -> &'static str {
    match mean {
        MeanRemoved::None => "no mean velocity was removed",
        MeanRemoved::PerFrame => "the mean velocity of each frame was removed",
        MeanRemoved::Overall => "the mean velocity over all frames was removed",
    }
}

fn noise_source(source: NoiseSource) -> &'static str {
    match source {
        NoiseSource::Given => "given on the command line",
        NoiseSource::DataSet => "stated by the data set",
        NoiseSource::Estimated => "estimated from these data",
        NoiseSource::Assumed => "assumed",
    }
}

fn fit_status(status: FitStatus) -> &'static str {
    match status {
        FitStatus::Converged => "converged",
        FitStatus::IterationLimit => "stopped at the limit of iterations",
        FitStatus::Stalled => "stalled before a minimum",
    }
}
