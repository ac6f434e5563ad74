//! Moduli with their errors beside the mean-field theory.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREY, INK, VERMILLION};
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::moduli_report::ModulusRecord;
use crate::series::ErrorPoint;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::label_with_unit;

/// Height of a row in pixels.
const ROW: f64 = 44.0;

/// A row for each modulus: every replica, their mean with its standard error, the mean without relaxation, and the honeycomb.
#[must_use]
pub fn moduli(records: &[ModulusRecord], unit: &str) -> String {
    let title = "moduli";
    let values = || {
        records
            .iter()
            .flat_map(|r| {
                [r.value - r.error, r.value + r.error].into_iter().chain(r.affine).chain(r.mean_field)
            })
            .filter(|value| value.is_finite())
    };
    let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
    if records.is_empty() || high <= low {
        return no_data(title);
    }
    let (room, rows) = (0.08 * (high - low), records.len() as f64);
    let layout = ChartLayout {
        title,
        size: [560.0, 90.0 + ROW * rows],
        left: 44.0,
        x: Axis::linear(&label_with_unit("modulus", unit), [low - room, high + room]),
        y: Axis::linear(" ", [0.0, rows]).without_ticks(),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    chart.curve(
        &[[0.0, 0.0], [0.0, rows]],
        &format!(r#"stroke="{INK}" stroke-width=".8" stroke-dasharray="3 3""#),
    );
    let theory_style = format!(r#"stroke="{VERMILLION}" stroke-width="2""#);
    let bar_style = format!(r#"stroke="{BLUE}" stroke-width="1.8""#);
    let (mut each, mut mean, mut affine) = (PathData::new(), PathData::new(), PathData::new());
    for (row, record) in records.iter().enumerate() {
        let middle = rows - row as f64 - 0.5;
        let [x, y] = chart.to_pixel([low - room, middle]);
        let style = TextStyle { size: 15.0, ..TextStyle::label(Anchor::End) };
        chart.svg.text([x - 12.0, y + 5.0], record.symbol, style);
        for value in record.replicas.iter().filter(|value| chart.contains([**value, middle])) {
            Marker::Circle.push(&mut each, chart.to_pixel([*value, middle - 0.27]), 2.0);
        }
        if let Some(value) = record.mean_field {
            chart.curve(&[[value, middle - 0.4], [value, middle + 0.4]], &theory_style);
        }
        if let Some(value) = record.affine {
            Marker::Diamond.push(&mut affine, chart.to_pixel([value, middle + 0.27]), 3.6);
        }
        let mut note = |what: &str, values: &[f64]| {
            chart
                .record(&format!("{}, {what}", record.symbol), values.iter().map(|&value| [value, f64::NAN]));
        };
        note("each replica", &record.replicas);
        note("without relaxation", record.affine.as_slice());
        note("mean-field theory", record.mean_field.as_slice());
        chart.record(
            record.symbol,
            [ErrorPoint { at: [record.value, f64::NAN], error: [Some(record.error), None] }],
        );
        if record.value.is_finite() {
            let ends = [record.value - record.error, record.value + record.error].map(|x| [x, middle]);
            chart.curve(&ends, &bar_style);
            Marker::Circle.push(&mut mean, chart.to_pixel([record.value, middle]), 4.0);
        }
    }
    let styles = [
        format!(r#"fill="{BLUE}""#),
        format!(r#"fill="{GREY}""#),
        format!(r#"fill="none" stroke="{INK}" stroke-width="1.2""#),
    ];
    for (path, style) in [(&mean, &styles[0]), (&each, &styles[1]), (&affine, &styles[2])] {
        chart.svg.path(path, style);
    }
    chart.frame();
    let mut key = vec![
        sample("after relaxation, standard error", Marker::Circle, 4.0, &styles[0]),
        sample("each replica", Marker::Circle, 2.0, &styles[1]),
    ];
    if records.iter().any(|record| record.affine.is_some()) {
        key.push(sample("without relaxation", Marker::Diamond, 3.6, &styles[2]));
    }
    if records.iter().any(|record| record.mean_field.is_some()) {
        key.push(KeyEntry::line("mean-field theory", &theory_style));
    }
    chart.finish_with_key(&key)
}

fn sample(label: &str, marker: Marker, size: f64, style: &str) -> KeyEntry {
    KeyEntry::new(label, |svg, at| {
        let mut mark = PathData::new();
        marker.push(&mut mark, at, size);
        svg.path(&mark, style);
    })
}
