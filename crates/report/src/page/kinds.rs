//! The cells of each label beside each other.

use super::Figure;
use super::parameter_table::{TableRow, parameter_rows};
use crate::chart::AxisScale;
use crate::colour::{BLUE, GREEN, GREY, VERMILLION};
use crate::figure::{ErrorPoint, PointSeries, PointsAndCurves, points_and_curves};
use crate::infer_report::{KindReport, Parameter};
use crate::markers::Marker;
use serde::Serialize;

/// Standard errors between the ends of a 95 % interval.
const WIDTH: f64 = 2.0 * 1.96;
const COLOURS: [&str; 4] = [BLUE, VERMILLION, GREEN, GREY];
const MARKERS: [Marker; 3] = [Marker::Circle, Marker::Square, Marker::Triangle];

/// One label in the table.
#[derive(Serialize)]
pub(super) struct KindRow {
    label: i64,
    cells: usize,
    words: String,
    parameters: Vec<TableRow>,
}

/// The table.
pub(super) fn rows(kinds: &[KindReport]) -> Vec<KindRow> {
    let row = |kind: &KindReport| KindRow {
        label: kind.label,
        cells: kind.cells,
        words: kind.words.clone(),
        parameters: parameter_rows(&kind.parameters, None).iter().map(TableRow::new).collect(),
    };
    kinds.iter().map(row).collect()
}

/// Preferred shape index and chirality of each kind.
pub(super) fn figure(kinds: &[KindReport]) -> Option<Figure> {
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
    (!kinds.is_empty()).then(|| Figure::new(drawn, caption))
}
