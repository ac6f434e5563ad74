//! The page of the command `moduli`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Card, Figure, PageHead, Template, render};
use crate::error::ReportError;
use crate::figure::moduli;
use crate::moduli_report::{
    DynamicModulusRecord, DynamicRecord, Estimate, MediumRecord, ModuliReport, ModulusRecord,
};
use crate::numbers::{NO_VALUE, significant};

const TEMPLATE: Template =
    Template { name: "moduli.html", source: include_str!("../../templates/moduli.html") };

/// Everything the page of `moduli` shows.
#[derive(Debug, Clone)]
pub struct ModuliPage<'a> {
    /// Title, for example the start.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// Figures of the moduli against frequency, where there are some.
    pub dynamic: Vec<Figure>,
    /// What `report.json` holds.
    pub report: &'a ModuliReport,
}

#[derive(Serialize, JsonSchema)]
struct Context<'a> {
    head: PageHead<'a>,
    report: &'a ModuliReport,
    figure: Figure,
    rows: Vec<Row>,
    viscosities: Vec<Row>,
    unit: String,
    dynamic: &'a [Figure],
    frequencies: Vec<[String; 5]>,
    media: Vec<Vec<String>>,
}

#[derive(Serialize, JsonSchema)]
struct Row {
    symbol: &'static str,
    name: String,
    cells: Vec<String>,
}

impl ModuliPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let report = self.report;
        let unit = report.units.powers(0, -1);
        let moduli_in_units = report.moduli.iter().map(|record| (record, &*unit));
        let viscosities = report.viscosities.iter().map(|record| (record, ""));
        let cards = moduli_in_units.chain(viscosities).map(|(record, unit)| Card {
            label: record.symbol.into(),
            value: format!("{} {unit}", significant(record.value, 3)).trim_end().to_owned(),
            note: format!("± {}", significant(record.error, 1)),
        });
        let cards = cards.collect();
        let context = Context {
            head: PageHead::sound([self.title, self.headline], self.summary, cards, &report.run),
            report,
            figure: Figure::new(
                moduli(&report.moduli, &unit),
                "Change of the mean stress by strain. B: pressure of a dilation, A: torque of a dilation, μ: shear stress along a \
                 shear, Kᵒ: shear stress at 45° to it.",
            ),
            rows: report.moduli.iter().map(row).collect(),
            viscosities: report.viscosities.iter().map(row).collect(),
            unit,
            dynamic: &self.dynamic,
            frequencies: report.dynamic.iter().map(frequency_row).collect(),
            media: report.media.iter().map(medium_row).collect(),
        };
        render(TEMPLATE, &context)
    }
}

fn row(record: &ModulusRecord) -> Row {
    let text = |value: Option<f64>| value.map_or(NO_VALUE.into(), |value| significant(value, 4));
    Row {
        symbol: record.symbol,
        name: record.name.replace('_', " "),
        cells: vec![
            significant(record.value, 4),
            significant(record.error, 2),
            text(record.mean_field),
            text(record.affine),
            record.nonlinearity.map_or(NO_VALUE.into(), |value| significant(value, 2)),
        ],
    }
}

/// ω, and both shear moduli in phase and out of phase.
fn frequency_row(record: &DynamicRecord) -> [String; 5] {
    let text = |name: &str, of: fn(&DynamicModulusRecord) -> &Estimate| {
        let found = record.moduli.iter().find(|own| own.name == name).map(of);
        found.map_or(NO_VALUE.into(), |own| {
            format!("{} ± {}", significant(own.value, 4), significant(own.error, 1))
        })
    };
    [
        significant(record.frequency, 4),
        text("shear", |own| &own.storage),
        text("shear", |own| &own.loss),
        text("odd_shear", |own| &own.storage),
        text("odd_shear", |own| &own.loss),
    ]
}

fn medium_row(record: &MediumRecord) -> Vec<String> {
    let name = match record.arrangement {
        "maxwell" => "Maxwell (in series)",
        _ => "Kelvin–Voigt (in parallel)",
    };
    let numbers = record.elasticity.into_iter().chain(record.viscosity);
    let missed = format!("{} %", significant(100.0 * record.missed, 2));
    [name.to_owned()].into_iter().chain(numbers.map(|value| significant(value, 3))).chain([missed]).collect()
}
