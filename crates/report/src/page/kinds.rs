//! The cells of each label beside each other.

use super::parameter_table::{parameter_rows, value_and_interval};
use super::{Block, Figure, Row, Section, Table, Text};
use crate::chart::AxisScale;
use crate::colour::{BLUE, GREEN, GREY, VERMILLION};
use crate::figure::{ErrorPoint, PointSeries, PointsAndCurves, points_and_curves};
use crate::infer_report::{KindReport, Parameter};
use crate::markers::Marker;
use crate::units::unit_text;

/// Standard errors between the ends of a 95 % interval.
const WIDTH: f64 = 2.0 * 1.96;
const COLOURS: [&str; 4] = [BLUE, VERMILLION, GREEN, GREY];
const MARKERS: [Marker; 3] = [Marker::Circle, Marker::Square, Marker::Triangle];

/// The section of the page; without content if cells are of one kind.
pub(super) fn section(kinds: &[KindReport]) -> Section {
    let section = Section::new("Kinds of cells");
    let Some(first) = kinds.first() else { return section };
    let heads = parameter_rows(&first.parameters, None).into_iter().map(|row| match unit_text(&row.unit) {
        unit if unit.is_empty() => Text::from(row.symbol),
        unit => Text::from(row.symbol) + " (" + Text::plain(&unit) + ")",
    });
    let header = ["label", "cells"].map(Text::from).into_iter().chain(heads);
    let row = |kind: &KindReport| -> Row {
        let parameters = parameter_rows(&kind.parameters, None).into_iter().map(|row| {
            let [value, interval] = value_and_interval(&row);
            Text::lines([value.into(), Text::marked("quiet", interval)])
        });
        let first = [kind.label.to_string(), kind.cells.to_string()].map(Text::from);
        first.into_iter().chain(parameters).collect()
    };
    section
        .with(Block::paragraph(
            "The cells of each label have parameters of their own; the first are those that others are compared with.",
        ))
        .with(Block::table(Table::new(header).rows(kinds.iter().map(row))))
        .with(Block::list(kinds.iter().map(|kind| &kind.words)))
        .with(Block::group("single", [figure(kinds)]))
}

/// Preferred shape index and chirality of each kind.
fn figure(kinds: &[KindReport]) -> Figure {
    let error = |parameter: &Parameter| {
        parameter.ci95.map(|[low, high]| (high - low) / WIDTH).filter(|error| error.is_finite())
    };
    let labels: Vec<String> = kinds.iter().map(|kind| format!("label {}", kind.label)).collect();
    let series: Vec<PointSeries<'_>> = (kinds.iter().zip(&labels).enumerate())
        .map(|(k, (kind, label))| {
            let (x, y) = (&kind.parameters.shape_index, &kind.parameters.alpha);
            let points = vec![ErrorPoint { at: [x.value, y.value], error: [error(x), error(y)] }];
            let (colour, marker) = (COLOURS[k % COLOURS.len()], MARKERS[k % MARKERS.len()]);
            PointSeries { label, colour, marker, points }
        })
        .collect();
    let drawn = points_and_curves(&PointsAndCurves {
        title: "kinds of cells",
        labels: ["preferred shape index P_0/ℓ_0", "chirality α"],
        scales: [AxisScale::Linear; 2],
        series: &series,
        curves: &[],
    });
    let caption = "What the cells of each label prefer, with standard errors. The parameters that were not let differ are shared, and so are their errors: \
                   compare by the differences in the report.";
    Figure::new(drawn, caption)
}
