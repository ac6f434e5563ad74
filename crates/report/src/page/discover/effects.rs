//! The effects that were added: size, interval, aliases.

use super::super::parameter_table::{cells_of, parameter_row};
use super::super::spreads::SpreadView;
use super::super::words::{effect_name, listed, percent, probability};
use super::super::{Block, Figure, Section, Table, Text};
use crate::discover_report::{DiscoverReport, SelectedEffect};
use crate::figure::{ParameterRow, PartialRegression, parameter_intervals, partial_regression};
use crate::units::Units;

/// The effects in the order of their selection, with what is drawn of them; `spreads` are those of cells that differ.
pub(super) fn section(
    report: &DiscoverReport,
    regressions: &[PartialRegression],
    spreads: &[SpreadView],
) -> Section {
    let heading = match report.selected.len() {
        0 | 1 => "The effect that was added",
        _ => "The effects that were added",
    };
    let section = Section::new(heading);
    if report.selected.is_empty() {
        return section;
    }
    let of = |effect: &SelectedEffect| {
        let effect = effect.effect.clone();
        let plots = regressions.iter().filter(move |plot| plot.effect == effect);
        plots.map(|plot| regression_figure(plot, &report.units))
    };
    let figures = report.selected.iter().flat_map(of).chain(spreads.iter().map(SpreadView::histogram));
    section
        .with_all(report.selected.iter().flat_map(told))
        .with(Block::group("beside", figures.chain(coefficient_figure(report))))
}

/// What is said of an effect.
fn told(effect: &SelectedEffect) -> Vec<Block> {
    let header = [("coefficient", ""), ("value", ""), ("95 % interval", ""), ("unit", "unit")];
    let coefficients = Table::new(header).class("").rows(rows(effect).iter().map(cells_of));
    let mut blocks = vec![
        Block::heading(effect_name(&effect.effect)),
        Block::paragraph(Text::prose(&effect.meaning)),
        Block::of_class("formula", &effect.formula),
        Block::table(coefficients),
        Block::remark(format!(
            "It explains {} of what the base model lacks beyond noise; adjusted p {}; family: {}.",
            percent(effect.share_of_excess),
            probability(effect.p_adjusted),
            effect.kind.name()
        )),
    ];
    blocks.extend((!effect.class.is_empty()).then(|| aliases(effect)));
    blocks
}

/// What else it could be, and what would tell.
fn aliases(effect: &SelectedEffect) -> Block {
    let others = listed(&effect.class, "or");
    let warning = format!("These data cannot tell {} from {others}.", effect_name(&effect.effect));
    let told_apart_by = effect.class.iter().filter_map(|alias| effect.told_apart_by.get_key_value(alias));
    let item = |(alias, by): (&String, &String)| Text::bold(effect_name(alias) + ":") + " " + Text::prose(by);
    Block::group(
        "aliases",
        [
            Block::paragraph(Text::bold(warning) + " Read the result as “one of these”."),
            Block::list(told_apart_by.map(item)),
        ],
    )
}

/// All coefficients with their intervals.
fn coefficient_figure(report: &DiscoverReport) -> Option<Figure> {
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
