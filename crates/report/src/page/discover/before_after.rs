//! The tables before against after: errors, noise, parameters.

use serde::Serialize;

use super::super::Figure;
use super::super::parameter_table::{TableRow, parameter_rows};
use super::super::words::{effect_name, noise_source, with_error};
use crate::discover_report::{DiscoverReport, HeldOutError, ModelFit, ModelNmse, Prediction};
use crate::figure::{Emphasis, ErrorBar, error_bars_with_floor};
use crate::numbers::significant;
use crate::units::unit_text;

/// Longest name of a model that stands beside its bar, in letters.
const LABEL: usize = 24;

/// Errors of the models side by side.
#[derive(Serialize)]
pub(super) struct Comparison {
    columns: Vec<String>,
    rows: Vec<ErrorRow>,
    figure: Figure,
}

#[derive(Serialize)]
struct ErrorRow {
    label: &'static str,
    cells: Vec<String>,
    note: String,
    is_main: bool,
}

/// Another data set, predicted.
#[derive(Serialize)]
pub(super) struct PredictionRow {
    dataset: String,
    velocities: usize,
    before: String,
    after: String,
    gain: String,
}

/// Other data sets, in the order given.
pub(super) fn predictions(report: &DiscoverReport) -> Vec<PredictionRow> {
    let error = |own: HeldOutError| with_error(own.value, own.standard_error);
    let row = |own: &Prediction| PredictionRow {
        dataset: own.dataset.clone(),
        velocities: own.velocities,
        before: error(own.before),
        after: error(own.after),
        gain: with_error(own.gain.value, own.gain.standard_error),
    };
    report.predictions.iter().map(row).collect()
}

/// One column of the table.
struct Column<'a> {
    model: Model,
    name: String,
    nmse: &'a ModelNmse,
    floor: f64,
    chi_square: f64,
}

/// Which model a column is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Model {
    Base,
    Extended,
    Description,
}

impl Model {
    /// Its name where there is no room for the effects.
    fn short_name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Extended => "base + effects",
            Self::Description => "base + description",
        }
    }
}

impl<'a> Column<'a> {
    fn of(model: Model, name: String, fit: &'a ModelFit) -> Self {
        let ModelFit { nmse, noise_floor_nmse, chi_square_per_dof, .. } = fit;
        Self { model, name, nmse, floor: *noise_floor_nmse, chi_square: *chi_square_per_dof }
    }
}

impl Comparison {
    pub(super) fn new(report: &DiscoverReport) -> Self {
        let columns = columns(report);
        Self {
            figure: error_figure(&columns),
            rows: rows(&columns),
            columns: columns.into_iter().map(|column| column.name).collect(),
        }
    }
}

fn columns(report: &DiscoverReport) -> Vec<Column<'_>> {
    let models = &report.models;
    let mut columns = vec![Column::of(Model::Base, "base".into(), &models.before)];
    if report.is_extended() {
        let added = report.selected.iter().map(|effect| effect_name(&effect.effect));
        let name = std::iter::once("base".to_owned()).chain(added).collect::<Vec<_>>().join(" + ");
        columns.push(Column::of(Model::Extended, name, &models.after));
    }
    columns.extend(report.description.as_ref().map(|fit| Column {
        model: Model::Description,
        name: "base + generic description".into(),
        nmse: &fit.nmse,
        floor: fit.noise_floor_nmse,
        chi_square: fit.chi_square_per_dof,
    }));
    columns
}

fn rows(columns: &[Column<'_>]) -> Vec<ErrorRow> {
    let row = |label, note: String, cell: &dyn Fn(&Column<'_>) -> String| ErrorRow {
        label,
        cells: columns.iter().map(cell).collect(),
        note,
        is_main: false,
    };
    let mut rows = Vec::new();
    let held_out = columns.first().and_then(|base| base.nmse.held_out());
    if let Some(error) = held_out {
        let frames = columns.iter().any(|column| column.nmse.held_out_frames.is_some());
        let [label, what] = if frames {
            ["error on frames held out", "runs of frames"]
        } else {
            ["error on cells held out", "blocks of cells"]
        };
        let note =
            format!("NMSE on data that the fit has not seen, {} {what}; the number to quote", error.folds);
        rows.push(ErrorRow {
            is_main: true,
            ..row(label, note, &|column| match column.nmse.held_out() {
                Some(error) => with_error(error.value, error.standard_error),
                None => number(f64::NAN),
            })
        });
    }
    rows.extend([
        row(
            "what noise alone leaves",
            "but for chance, no prediction of new data gets below it".into(),
            &|column| number(column.floor),
        ),
        row("error at measured positions", "all cells, without their nudges".into(), &|column| {
            number(column.nmse.un_nudged)
        }),
        row("error of least squares", "parameters found without nudges".into(), &|column| {
            number(column.nmse.naive)
        }),
        row(
            "error of the fit itself",
            "always too good: the nudges were chosen with these velocities".into(),
            &|column| number(column.nmse.nudged),
        ),
        row("χ² per degree of freedom", "1 if model and noise levels are right".into(), &|column| {
            number(column.chi_square)
        }),
    ]);
    rows.retain(|row| row.cells.iter().any(|cell| *cell != crate::numbers::NO_VALUE));
    rows
}

fn number(value: f64) -> String {
    significant(value, 3)
}

/// The number to quote of each model, and the least that noise leaves.
fn error_figure(columns: &[Column<'_>]) -> Figure {
    let is_held_out = columns.first().is_some_and(|base| base.nmse.held_out().is_some());
    let bar = |column: &Column<'_>| {
        let held_out = column.nmse.held_out().filter(|_| is_held_out);
        let label =
            if column.name.chars().count() <= LABEL { &column.name } else { column.model.short_name() };
        ErrorBar {
            label: label.to_owned(),
            nmse: held_out.map_or(column.nmse.un_nudged, |error| error.value),
            standard_error: held_out.map(|error| error.standard_error),
            emphasis: match column.model {
                Model::Base | Model::Extended => Emphasis::Main,
                Model::Description => Emphasis::Quiet,
            },
        }
    };
    let bars: Vec<ErrorBar> = columns.iter().map(bar).collect();
    let floor = columns.iter().map(|column| column.floor).fold(f64::NAN, f64::min);
    let what = if is_held_out { "on data that the fit has not seen" } else { "at measured positions" };
    let spread =
        if bars.iter().any(|bar| bar.standard_error.is_some()) { ", with standard errors" } else { "" };
    let line = match (floor.is_finite(), columns.len()) {
        (false, _) => "",
        (true, 1) => " The line is what noise alone leaves.",
        (true, _) => " The line is what noise alone leaves of the best model.",
    };
    let caption = format!("Share of the squared velocities left unexplained {what}{spread}.{line}");
    Figure::new(error_bars_with_floor(&bars, Some(floor)), &caption)
}

/// One row of the table of noise and nudges.
#[derive(Serialize)]
pub(super) struct NoiseRow {
    label: String,
    unit: String,
    cells: Vec<String>,
}

pub(super) fn noise_rows(report: &DiscoverReport) -> Vec<NoiseRow> {
    let mut models = vec![&report.models.before];
    if report.is_extended() {
        models.push(&report.models.after);
    }
    let row = |label: &str, unit: &str, cell: fn(&ModelFit) -> String| NoiseRow {
        label: label.to_owned(),
        unit: unit_text(unit),
        cells: models.iter().map(|model| cell(model)).collect(),
    };
    let units = &report.units;
    let velocity = units.velocity_text();
    let source = noise_source(report.models.before.noise.source);
    vec![
        row(&format!("position noise σ_r, {source}"), &units.length, |model| number(model.noise.sigma_r)),
        row(&format!("velocity noise σ_v, {source}"), &velocity, |model| number(model.noise.sigma_v)),
        row("spring constant k = σ_v²/σ_r²", &units.powers(0, -2), |model| number(model.nudge.k)),
        row("root mean square nudge", &units.length, |model| number(model.nudge.rms)),
        row("degrees of freedom used by nudges", "", |model| number(model.nudge.degrees_of_freedom)),
        row("contribution of nudges over that of velocities", "", |model| {
            number(model.nudge.contribution_ratio)
        }),
        row("the same if the noise levels are right", "", |model| {
            number(model.nudge.expected_contribution_ratio)
        }),
        row("contacts changed by nudges", "", |model| model.nudge.edges_changed.to_string()),
    ]
}

/// One parameter before and after.
#[derive(Serialize)]
pub(super) struct ParameterComparison {
    before: TableRow,
    after: TableRow,
}

pub(super) fn parameters(report: &DiscoverReport) -> Vec<ParameterComparison> {
    let rows = |fit: &ModelFit| parameter_rows(&fit.parameters, None);
    let pairs = rows(&report.models.before).into_iter().zip(rows(&report.models.after));
    pairs
        .map(|(before, after)| ParameterComparison {
            before: TableRow::new(&before),
            after: TableRow::new(&after),
        })
        .collect()
}
