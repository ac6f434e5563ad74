//! The page of the command `infer`.

use serde::Serialize;

use super::kinds::{self, KindRow};
use super::parameter_table::{TableRow, activity_rows, parameter_rows};
use super::player::Player;
use super::prospects::ProspectsView;
use super::spreads::SpreadView;
use super::uncertainty::{Known, Uncertainty};
use super::words::{POLARITIES, data, fit_status, mean_removed, noise_source, warnings};
use super::{Card, Columns, Figure, PageHead, Panel, Template, render};
use crate::arrows::ArrowScale;
use crate::error::ReportError;
use crate::figure::{
    CellScalar, Emphasis, ErrorBar, FlowMap, NudgeHistogram, ObjectiveTrace, ParameterRow, Prediction,
    VelocityField, cell_map, error_bars, flow_map, nudge_histogram, nudge_map, objective_trace, polarity_map,
    predicted_against_measured, velocity_map,
};
use crate::infer_report::InferReport;
use crate::many_cells::{Squares, middle};
use crate::map::MOST_DRAWN;
use crate::movie::CellMovie;
use crate::numbers::{NO_VALUE, significant};
use crate::units::unit_text;
use crate::view::FrameView;

const TEMPLATE: Template =
    Template { name: "infer.html", source: include_str!("../../templates/infer.html") };

/// The caption of the cells of all frames.
const CELLS: &str = "Cells where they were seen, with what the fit makes of them. The residual is what the model leaves of the \
                     measured velocity.";

/// Everything the page of `infer` shows.
#[derive(Debug, Clone, Copy)]
pub struct InferPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// What `report.json` holds.
    pub report: &'a InferReport,
    /// The frames to draw; each adds about 0.5 kB per cell to the page.
    pub frames: &'a [FrameView],
    /// The cells of all frames, if there are any.
    pub movie: Option<&'a CellMovie>,
    /// Velocities of the frames to draw, one map for each frame, where these are on a grid; empty otherwise.
    pub flows: &'a [FlowMap<'a>],
    /// Deviations of the cells in each parameter in which they may differ; empty if they may not.
    pub spreads: &'a [SpreadView],
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
        let of_activity = report.activity.as_ref().map(activity_rows).unwrap_or_default();
        let head = PageHead {
            title: self.title,
            headline: &report.verdict.sentence,
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
            spring_unit: report.units.powers(0, -2),
            data: data(report.flow.as_ref()),
            is_finding: report.verdict.kind.is_finding(),
            cell_size: cell_size(report),
            known: Known::new(report, &rows, self.uncertainty),
            prospects: ProspectsView::new(report.prospects.as_ref()),
            parameters: rows.iter().chain(&of_activity).map(TableRow::new).collect(),
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
            spread_figures: self.spreads.iter().map(SpreadView::histogram).collect(),
            kinds: kinds::rows(&report.by_label),
            kind_figure: kinds::figure(&report.by_label),
            player: self
                .movie
                .map(|movie| Player::new(movie, &Figure::new(movie.still(), CELLS)))
                .transpose()?,
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

    fn panels(&self) -> Vec<Panel> {
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
            Panel { label: whole.label.clone(), figures, columns: Columns::for_cells(whole.cells.len()) }
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
    spring_unit: String,
    data: &'static str,
    is_finding: bool,
    cell_size: String,
    known: Known,
    prospects: Option<ProspectsView>,
    parameters: Vec<TableRow>,
    error_figure: Figure,
    trace_figure: Figure,
    scatter_figure: Figure,
    nudge_figure: Figure,
    spread_figures: Vec<Figure>,
    kinds: Vec<KindRow>,
    kind_figure: Option<Figure>,
    player: Option<Player>,
    panels: Vec<Panel>,
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

/// What ℓ₀ is in the units of the data, unless that is the unit of length itself.
fn cell_size(report: &InferReport) -> String {
    let scale = &report.length_scale;
    let size = significant(scale.value, 3);
    match (scale.unit.as_str(), size.as_str()) {
        ("ℓ₀" | "l_0", "1.00") => {
            "Lengths are in units of the cell size ℓ_0: ℓ_0² is the mean area of the cells.".into()
        }
        ("ℓ₀" | "l_0", _) => format!(
            "Lengths are in units of the ℓ_0 of the data set; the square root of the mean area of the cells used is {size} of it."
        ),
        (unit, _) => {
            let unit = unit_text(unit);
            format!("The cell size is ℓ_0 = {size} {unit} (ℓ_0² is the mean area of the cells used).")
        }
    }
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
    // What explains nothing has no key parameters.
    let shown = if report.verdict.kind.is_finding() { 3 } else { 0 };
    let mut cards: Vec<Card> = rows.iter().take(shown).map(parameter).collect();
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
