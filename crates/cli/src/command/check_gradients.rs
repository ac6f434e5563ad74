//! `voronudge check-gradients`: every derivative against independent ways to get it.

use crate::arguments::{CommonArguments, DataSetArguments, EffectArguments, ParameterArguments};
use crate::boundary::domain;
use crate::failure::Failure;
use crate::reporting::{Answer, Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write as _;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_io::{FrameSelection, Snapshot};
use voronudge_model::Model;
use voronudge_model::gradient_check::{GradientReport, Place, check, check_model, made_up_environment};
use voronudge_report::infer_report::RunRecord;
use voronudge_simulate::{RandomPlacement, check_run, generator};

/// Checks the derivatives and symmetries of every force term and effect at given or built-in positions.
///
/// Prints a table with the term, the quantity, the worst error relative to the largest magnitude, where it occurs,
/// and the tolerance. Exits with 1 if a check fails.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    data: DataSetArguments,
    /// Frames to check, counted from zero: `6`, `4..16` (end excluded) or `4,7,9` [default: the first].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    effects: EffectArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Cells of the built-in configurations.
const BUILT_IN_CELLS: usize = 100;

#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    run: RunRecord,
    /// Whether all checks passed.
    passed: bool,
    /// Result of each check.
    checks: Vec<Check>,
}

#[derive(Serialize, JsonSchema)]
struct Check {
    /// The cells: file and frame, or a built-in configuration.
    configuration: String,
    /// The force term, the effect, the whole model, or `geometry`.
    term: String,
    /// Which quantities are compared.
    quantity: String,
    /// Largest error, relative to the largest magnitude compared.
    worst: f64,
    /// Where the largest error occurs.
    place: String,
    /// Largest error that passes: 1e-10, or 1e-6 for central differences in positions.
    tolerance: f64,
    /// Whether the check passed.
    passed: bool,
}

impl Reporting for Arguments {
    const NAME: &'static str = "check-gradients";
    type Report = Report;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let parameters = self.parameters.resolve()?;
        let effects = self.effects.resolve()?;
        let given = self.data.dataset.is_some() || self.data.positions.is_some();
        let data = given.then(|| self.data.load()).transpose()?;
        let inputs = data.iter().flat_map(|data| &data.inputs).map(AsRef::as_ref);
        let out = match &self.common.out {
            Some(_) => Some(self.common.output(inputs.chain(self.parameters.file()))?),
            None => self.common.rehearse(inputs.chain(self.parameters.file())).map(|()| None)?,
        };
        let mut subjects: Vec<(String, Snapshot, Domain)> = Vec::new();
        match &data {
            Some(data) => {
                let file = self.data.positions_file();
                let frames = match &self.frames {
                    Some(selection) => selection
                        .resolve(data.frames())
                        .map_err(|error| Failure::from(error).at(file.display()))?,
                    None => vec![0],
                };
                for frame in frames {
                    let name = format!("{}, frame {frame}", file.display());
                    subjects.push((name, Snapshot::new(data, frame), domain(data)?));
                }
            }
            None => {
                let side = (BUILT_IN_CELLS as f64).sqrt();
                let cell_box = PeriodicBox::new([side, side])?;
                let positions =
                    RandomPlacement::new(BUILT_IN_CELLS, cell_box).draw(&mut generator(self.common.seed))?;
                for (name, domain) in [("periodic", Domain::Periodic(cell_box)), ("open", Domain::Open)] {
                    let snapshot =
                        Snapshot { cells: (0..BUILT_IN_CELLS).collect(), positions: positions.clone() };
                    subjects.push((format!("{BUILT_IN_CELLS} random cells, {name}"), snapshot, domain));
                }
            }
        }
        let mut reports = Vec::new();
        for (name, snapshot, domain) in subjects {
            let mut report = check(&snapshot.positions, domain, &parameters)
                .map_err(|error| Failure::from(snapshot.in_file_numbers(error)).at(&name))?;
            if !effects.is_empty() {
                let environment = made_up_environment(&snapshot.positions, domain)?;
                let model = effects.add_to(Model::chiral_voronoi(&parameters), environment, domain)?;
                report.rows.extend(check_model(&snapshot.positions, domain, &model)?.rows);
            }
            if matches!(domain, Domain::Periodic(_)) {
                report.rows.extend(check_run(&snapshot.positions, domain, &parameters)?);
            }
            for row in &mut report.rows {
                renumber(&mut row.place, &snapshot.cells);
            }
            reports.push((name, report));
        }
        let passed = reports.iter().all(|(_, report)| report.passed());
        let checks = reports.iter().flat_map(|(name, report)| rows(name, report)).collect();
        let report = Report { run: run.record(data.as_ref()), passed, checks };
        Ok(Rendered::new(out, &report, table(&reports))?.with_answer(Answer::of(passed)))
    }
}

/// Numbers the cells of a place as in the file, where absent cells count.
fn renumber(place: &mut Place, cells: &[usize]) {
    match place {
        Place::Total { .. } => {}
        Place::Cell { cell, .. } | Place::Corner { cell, .. } => *cell = cells[*cell],
        Place::Entry { cell, by, .. } => (*cell, *by) = (cells[*cell], cells[*by]),
    }
}

fn rows(name: &str, report: &GradientReport) -> Vec<Check> {
    report
        .rows
        .iter()
        .map(|row| Check {
            configuration: name.into(),
            term: row.term.clone(),
            quantity: row.quantity.to_string(),
            worst: row.worst,
            place: row.place.to_string(),
            tolerance: row.tolerance,
            passed: row.passed(),
        })
        .collect()
}

fn table(reports: &[(String, GradientReport)]) -> String {
    let mut text = String::new();
    for (name, report) in reports {
        let displaced = match report.displaced {
            d if d == report.cells => String::new(),
            d => format!(" ({d} of them displaced)"),
        };
        let _ = writeln!(text, "{name}: {} cells{displaced}\n", report.cells);
        let header = ["term", "quantity", "worst error", "tolerance", "", "where"].map(String::from);
        let rows: Vec<[String; 6]> = std::iter::once(header)
            .chain(report.rows.iter().map(|row| {
                [
                    row.term.clone(),
                    row.quantity.to_string(),
                    format!("{:.1e}", row.worst),
                    format!("{:.0e}", row.tolerance),
                    if row.passed() { "ok" } else { "FAILED" }.into(),
                    row.place.to_string(),
                ]
            }))
            .collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..6).map(width).collect();
        for row in &rows {
            let line: Vec<String> =
                row.iter().zip(&widths).map(|(entry, &width)| format!("{entry:width$}")).collect();
            let _ = writeln!(text, "{}", line.join("  ").trim_end());
        }
        let failed = report.rows.iter().filter(|row| !row.passed()).count();
        let _ = match failed {
            0 => writeln!(text, "\nall {} checks passed\n", report.rows.len()),
            _ => writeln!(text, "\n{failed} of {} checks FAILED\n", report.rows.len()),
        };
    }
    text
}
