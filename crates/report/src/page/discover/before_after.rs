//! The tables before against after: errors, noise, parameters, other data.

use super::super::directions::directions;
use super::super::parameter_table::{cells_of, parameter_rows};
use super::super::words::{self, data, effect_name, listed, noise_source, with_error};
use super::super::{Block, Cell, Figure, Row, Section, Table, Text};
use crate::discover_report::{DiscoverReport, HeldOutError, ModelFit, ModelNmse, Prediction};
use crate::figure::{Emphasis, ErrorBar, ParameterRow, error_bars_with_floor, noise_budget};
use crate::numbers::{NO_VALUE, significant};
use crate::units::unit_text;

/// Longest name of a model that stands beside its bar, in letters.
const LABEL: usize = 24;

/// Errors of the models side by side.
pub(super) fn errors(report: &DiscoverReport) -> Section {
    let columns = columns(report);
    let names = columns.iter().map(|column| Cell::from(&column.name));
    let header = [Cell::default()].into_iter().chain(names).chain([("", "text quiet").into()]);
    let frames = match report.cells.frames.len() {
        0 | 1 => String::new(),
        count => format!(", over {count} frames"),
    };
    let how = format!(
        "For the errors, {}. {} {} were used{frames}.",
        words::mean_removed(report.models.before.nmse.mean_removed),
        report.cells.used,
        data(report.flow.as_ref())
    );
    let is_extended = report.is_extended();
    Section::new(if is_extended { "Before and after" } else { "How well the base model fits" })
        .with(Block::table(Table::new(header).class("comparison").rows(error_rows(&columns))))
        .with(Block::remark(how))
        .with(Block::group("narrow", [error_figure(&columns)]))
}

/// Other data sets, in the order given.
pub(super) fn predictions(report: &DiscoverReport) -> Section {
    let section = Section::new("Other data predicted");
    if report.predictions.is_empty() {
        return section;
    }
    let error = |own: HeldOutError| with_error(own.value, own.standard_error).into();
    let row = |own: &Prediction| -> [Text; 5] {
        [
            Text::plain(&own.dataset),
            own.velocities.to_string().into(),
            error(own.before),
            error(own.after),
            with_error(own.gain.value, own.gain.standard_error).into(),
        ]
    };
    let header = ["data set", data(report.flow.as_ref()), "base model", "with effects", "gain"];
    let table = Table::new(header).class("").rows(report.predictions.iter().map(row));
    section
        .with(Block::paragraph(
            "Velocities of other data sets, predicted with everything as it was fitted here. An error of 1 is that of no prediction at all.",
        ))
        .with(Block::table(table))
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

fn error_rows(columns: &[Column<'_>]) -> Vec<Row> {
    let row = |label: &str, note: &str, cell: &dyn Fn(&Column<'_>) -> String| {
        let cells: Vec<String> = columns.iter().map(cell).collect();
        let is_known = cells.iter().any(|cell| cell != NO_VALUE);
        let all = [label.to_owned()].into_iter().chain(cells).chain([note.to_owned()]);
        is_known.then(|| all.collect::<Row>())
    };
    let held_out = columns.first().and_then(|base| base.nmse.held_out()).and_then(|error| {
        let frames = columns.iter().any(|column| column.nmse.held_out_frames.is_some());
        let [label, what] = if frames {
            ["error on frames held out", "runs of frames"]
        } else {
            ["error on cells held out", "blocks of cells"]
        };
        let note =
            format!("NMSE on data that the fit has not seen, {} {what}; the number to quote", error.folds);
        let row = row(label, &note, &|column| match column.nmse.held_out() {
            Some(error) => with_error(error.value, error.standard_error),
            None => NO_VALUE.to_owned(),
        });
        Some(row?.main(true))
    });
    let others = [
        row(
            "what noise alone leaves",
            "but for chance, no prediction of new data gets below it",
            &|column| number(column.floor),
        ),
        row("error at measured positions", "all cells, without their nudges", &|column| {
            number(column.nmse.un_nudged)
        }),
        row("error of least squares", "parameters found without nudges", &|column| number(column.nmse.naive)),
        row(
            "error of the fit itself",
            "always too good: the nudges were chosen with these velocities",
            &|column| number(column.nmse.nudged),
        ),
        row("χ² per degree of freedom", "1 if model and noise levels are right", &|column| {
            number(column.chi_square)
        }),
    ];
    [held_out].into_iter().chain(others).flatten().collect()
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

/// Where the squared velocities go, and noise and nudges of the models.
pub(super) fn noise(report: &DiscoverReport) -> Section {
    let budget = &report.noise_budget;
    let table = Block::table(noise_table(report));
    if !budget.before.is_known() {
        return Section::new("Noise").with(table);
    }
    let mut bars = vec![("base model", budget.before)];
    if report.is_extended() {
        bars.push(("with effects", budget.after));
    }
    let figure = Figure::new(
        noise_budget(&bars),
        "Where the squared velocities go. Noise of positions counts because the forces of the model depend \
         sensitively on positions.",
    );
    let total = format!("{} {}", number(budget.before.total), report.units.powers(2, -2));
    let total = format!("Σ|v|² over the {} used is {total}.", data(report.flow.as_ref()));
    Section::new("Noise budget")
        .with(Block::group("wide", [figure]))
        .with(Block::remark(Text::plain(&total)))
        .with(table)
}

fn noise_table(report: &DiscoverReport) -> Table {
    let mut models = vec![&report.models.before];
    if report.is_extended() {
        models.push(&report.models.after);
    }
    let row = |label: &str, unit: &str, cell: fn(&ModelFit) -> String| -> Row {
        let cells = models.iter().map(|model| Text::from(cell(model)));
        [label.into()].into_iter().chain(cells).chain([Text::plain(&unit_text(unit))]).collect()
    };
    let units = &report.units;
    let velocity = units.velocity_text();
    let source = noise_source(report.models.before.noise.source);
    let rows = [
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
    ];
    let names: &[&str] = if report.is_extended() { &["", "before", "after"] } else { &["", ""] };
    let header = names.iter().copied().map(Cell::from).chain([("", "unit").into()]);
    Table::new(header).class("").rows(rows)
}

/// Parameters of the base model, and what the data determine of the last one.
pub(super) fn parameters(report: &DiscoverReport) -> Section {
    let is_extended = report.is_extended();
    let models = if is_extended { vec!["before", "after"] } else { vec!["value"] };
    let header = models.iter().flat_map(|model| [*model, "95 % interval"]);
    let ends = [Cell::from(("unit", "unit")), ("meaning", "text").into()];
    let header = [""].into_iter().chain(header).map(Cell::from).chain(ends);
    let of = |fit: &ModelFit| parameter_rows(&fit.parameters, None);
    let row = |(before, after): (ParameterRow, ParameterRow)| -> Vec<Text> {
        let ([symbol, value, interval, unit], [_, value_after, interval_after, _]) =
            (cells_of(&before), cells_of(&after));
        let mut cells = vec![symbol, value, interval];
        cells.extend(is_extended.then_some([value_after, interval_after]).into_iter().flatten());
        cells.extend([unit, Text::plain(&before.meaning)]);
        cells
    };
    let rows = of(&report.models.before).into_iter().zip(of(&report.models.after)).map(row);
    let added = listed(report.selected.iter().map(|effect| &effect.effect), "and");
    let (heading, remark, whose) = match is_extended {
        true => (
            "Parameters of the base model, before and after",
            "A parameter that moves by more than its interval was biased by what the base model lacked.",
            format!(" of the model with {added}"),
        ),
        false => ("Parameters of the base model", "", String::new()),
    };
    Section::new(heading)
        .with(Block::table(Table::new(header).rows(rows)))
        .with(Block::remark(remark))
        .with_part(
            "What the data determine",
            &format!("Directions in the space of all coefficients{whose}, best determined first."),
            directions(&report.models.after.identifiability),
        )
}
