//! The effects that were added: size, interval, aliases.

use serde::Serialize;

use super::super::Figure;
use super::super::parameter_table::{TableRow, parameter_row};
use super::super::words::{effect_name, listed, percent, probability};
use crate::discover_report::{DiscoverReport, SelectedEffect};
use crate::figure::{ParameterRow, PartialRegression, parameter_intervals, partial_regression};
use crate::units::Units;

/// One selected effect.
#[derive(Serialize)]
pub(super) struct EffectView {
    name: String,
    formula: String,
    meaning: String,
    family: &'static str,
    p_adjusted: String,
    share_of_excess: String,
    coefficients: Vec<TableRow>,
    class: String,
    told_apart_by: Vec<(String, String)>,
    regressions: Vec<Figure>,
}

/// The selected effects in the order of their selection.
pub(super) fn views(report: &DiscoverReport, regressions: &[PartialRegression]) -> Vec<EffectView> {
    let view = |effect: &SelectedEffect| {
        let plots = regressions.iter().filter(|plot| plot.effect == effect.effect);
        let told_apart_by = effect.class.iter().filter_map(|alias| effect.told_apart_by.get_key_value(alias));
        EffectView {
            name: effect_name(&effect.effect),
            formula: effect.formula.clone(),
            meaning: effect.meaning.clone(),
            family: effect.kind.name(),
            p_adjusted: probability(effect.p_adjusted),
            share_of_excess: percent(effect.share_of_excess),
            coefficients: rows(effect).iter().map(TableRow::new).collect(),
            class: listed(&effect.class, "or"),
            told_apart_by: told_apart_by.map(|(alias, by)| (effect_name(alias), by.clone())).collect(),
            regressions: plots.map(|plot| regression_figure(plot, &report.units)).collect(),
        }
    };
    report.selected.iter().map(view).collect()
}

/// All coefficients with their intervals.
pub(super) fn coefficient_figure(report: &DiscoverReport) -> Option<Figure> {
    let rows: Vec<ParameterRow> = report.selected.iter().flat_map(rows).collect();
    let figure = || {
        Figure::new(
            parameter_intervals(&rows),
            "Each coefficient on its own axis; the dashed upright line is zero.",
        )
    };
    (!rows.is_empty()).then(figure)
}

/// The coefficients of an effect.
pub(super) fn rows(effect: &SelectedEffect) -> Vec<ParameterRow> {
    let named = effect.parameters();
    named.iter().map(|(name, parameter)| parameter_row(name, parameter, None, &parameter.words)).collect()
}

fn regression_figure(plot: &PartialRegression, units: &Units) -> Figure {
    Figure::new(
        partial_regression(plot, units),
        "What the base model leaves unexplained against what the effect predicts, cell by cell, after removing \
         from both what the base model can explain. A slope without a cloud that follows it is carried by few \
         cells.",
    )
}
