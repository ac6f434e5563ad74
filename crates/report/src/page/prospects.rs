//! The tables of what would be known if more, or better, had been measured.

use std::collections::BTreeMap;

use super::parameter_table::symbol_of;
use super::{Block, Cell, Row, Table, Text};
use crate::infer_report::{AmbiguityReport, DESIGNS, ProspectOf, ProspectsReport};
use crate::numbers::{NO_VALUE, significant};
use crate::units::unit_text;

/// The tables, with a cell for each measurement; those that cannot be judged have no column.
pub(super) fn blocks(report: &ProspectsReport) -> Vec<Block> {
    let expected = report.quantities.iter().map(|own| &own.expected);
    let all: Vec<&BTreeMap<String, f64>> =
        expected.chain(report.ambiguities.iter().map(|own| &own.expected)).collect();
    let shown: Vec<(&str, &str)> =
        DESIGNS.into_iter().filter(|(name, _)| all.iter().any(|own| own.contains_key(*name))).collect();
    let header = |first| {
        let names = [first, "now"].into_iter().chain(shown.iter().map(|(_, words)| *words));
        names.map(Cell::from)
    };
    let quantity = |own: &ProspectOf| {
        let name = symbol_of(&own.name).into();
        let mut cells = cells(&shown, name, own.standard_error, &own.expected, f64::min);
        cells.push(Text::plain(&unit_text(&own.unit)));
        Row::from(cells).main(report.least_certain.as_ref() == Some(&own.name))
    };
    let ambiguity = |own: &AmbiguityReport| {
        let name = Text::plain(&format!("{} or {}", symbol_of(&own.effect), symbol_of(&own.other)));
        let cells = cells(&shown, name, own.separation, &own.expected, f64::max);
        Row::from(cells).main(report.least_certain == Some(own.name()))
    };
    let errors = Table::new(header("standard error").chain([("", "unit").into()]));
    let errors = errors.class("prospects").rows(report.quantities.iter().map(quantity));
    let mut blocks = vec![Block::table(errors)];
    if !report.ambiguities.is_empty() {
        blocks.push(Block::paragraph(
            "By how many standard errors an effect stands out beside the one that could stand in its place: some three tell them apart.",
        ));
        let apart = Table::new(header("told apart by")).class("prospects");
        blocks.push(Block::table(apart.rows(report.ambiguities.iter().map(ambiguity))));
    }
    blocks.push(Block::remark(
        "What a fit would know if that had been measured instead, by the Fisher information at this fit: further frames and cells like these, errors of the same size, \
         of the model as it is.",
    ));
    blocks
}

/// A quantity, or two effects, now and by each measurement; the best is bold.
fn cells(
    shown: &[(&str, &str)],
    name: Text,
    now: f64,
    expected: &BTreeMap<String, f64>,
    best: fn(f64, f64) -> f64,
) -> Vec<Text> {
    let found = shown.iter().map(|(name, _)| expected.get(*name).copied());
    let of_all = found.clone().flatten().reduce(best);
    let cell = |value: Option<f64>| {
        let text = value.map_or_else(|| NO_VALUE.to_owned(), |value| significant(value, 2));
        let text = if value.is_some() && value == of_all { Text::bold(text) } else { text.into() };
        let share = value.map_or_else(String::new, |value| format!("(× {})", significant(value / now, 2)));
        text + " " + Text::marked("quiet", share)
    };
    let first = [name, significant(now, 2).into()];
    first.into_iter().chain(found.map(cell)).collect()
}
