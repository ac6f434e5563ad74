//! The table of what would be known if more, or better, had been measured.

use std::collections::BTreeMap;

use serde::Serialize;

use super::parameter_table::symbol_of;
use crate::infer_report::{DESIGNS, ProspectsReport};
use crate::numbers::{NO_VALUE, significant};
use crate::units::unit_text;

/// The table; measurements that cannot be judged have no column.
#[derive(Serialize)]
pub(super) struct ProspectsView {
    words: String,
    columns: Vec<String>,
    rows: Vec<Row>,
    ambiguities: Vec<Row>,
}

/// A quantity, or two effects, and a cell for each measurement.
#[derive(Serialize)]
struct Row {
    name: String,
    unit: String,
    now: String,
    cells: Vec<Cell>,
    /// Whether it is what is least certain.
    is_main: bool,
}

#[derive(Serialize)]
struct Cell {
    text: String,
    /// As a share of now.
    share: String,
    /// Whether it is the best of its row.
    is_best: bool,
}

impl ProspectsView {
    /// None where nothing is foreseen.
    pub(super) fn new(report: Option<&ProspectsReport>) -> Option<Self> {
        let report = report.filter(|own| !own.quantities.is_empty())?;
        let expected = report.quantities.iter().map(|own| &own.expected);
        let all: Vec<&BTreeMap<String, f64>> =
            expected.chain(report.ambiguities.iter().map(|own| &own.expected)).collect();
        let shown: Vec<(&str, &str)> =
            DESIGNS.into_iter().filter(|(name, _)| all.iter().any(|own| own.contains_key(*name))).collect();
        let cells = |now: f64, expected: &BTreeMap<String, f64>, best: fn(f64, f64) -> f64| -> Vec<Cell> {
            let found = shown.iter().map(|(name, _)| expected.get(*name).copied());
            let of_all = found.clone().flatten().reduce(best);
            let cell = |value: Option<f64>| Cell {
                text: value.map_or_else(|| NO_VALUE.to_owned(), |value| significant(value, 2)),
                share: value.map_or_else(String::new, |value| format!("(× {})", significant(value / now, 2))),
                is_best: value.is_some() && value == of_all,
            };
            found.map(cell).collect()
        };
        let rows = report.quantities.iter().map(|own| Row {
            name: symbol_of(&own.name),
            unit: unit_text(&own.unit),
            now: significant(own.standard_error, 2),
            cells: cells(own.standard_error, &own.expected, f64::min),
            is_main: report.least_certain.as_ref() == Some(&own.name),
        });
        let ambiguities = report.ambiguities.iter().map(|own| Row {
            name: format!("{} or {}", symbol_of(&own.effect), symbol_of(&own.other)),
            unit: String::new(),
            now: significant(own.separation, 2),
            cells: cells(own.separation, &own.expected, f64::max),
            is_main: report.least_certain == Some(own.name()),
        });
        Some(Self {
            words: report.words.clone(),
            columns: shown.iter().map(|(_, words)| (*words).to_owned()).collect(),
            rows: rows.collect(),
            ambiguities: ambiguities.collect(),
        })
    }
}
