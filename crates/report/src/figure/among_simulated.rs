//! A measured function among those of simulated movies.

use super::no_data;
use crate::chart::{Axis, AxisScale, Chart, ChartLayout};
use crate::colour::INK;
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::svg::PathData;

/// The functions of many simulated movies.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedBand<'a> {
    /// Name in the key.
    pub label: &'a str,
    /// Colour.
    pub colour: &'a str,
    /// Along the axis.
    pub at: &'a [f64],
    /// Below which few movies lie.
    pub low: &'a [f64],
    /// In the middle of them.
    pub median: &'a [f64],
    /// Above which few lie.
    pub high: &'a [f64],
}

/// Bands of simulated movies, their medians, and the measured function as marks. What a logarithm cannot show is left out.
#[must_use]
pub fn among_simulated(
    title: &str,
    labels: [&str; 2],
    scales: [AxisScale; 2],
    measured: &[[f64; 2]],
    bands: &[SimulatedBand<'_>],
) -> String {
    let fits = |at: [f64; 2]| {
        at.into_iter().zip(scales).all(|(x, scale)| x.is_finite() && (scale == AxisScale::Linear || x > 0.0))
    };
    let corners = bands.iter().flat_map(|band| {
        let end = |values: &'_ [f64]| band.at.iter().copied().zip(values.to_vec()).collect::<Vec<_>>();
        end(band.low).into_iter().chain(end(band.high)).map(|(x, y)| [x, y])
    });
    let all: Vec<[f64; 2]> = measured.iter().copied().chain(corners).filter(|at| fits(*at)).collect();
    let axis = |which: usize| Axis::holding(labels[which], scales[which], all.iter().map(|at| at[which]));
    let layout =
        axis(0).zip(axis(1)).map(|(x, y)| ChartLayout { title, size: [440.0, 290.0], left: 66.0, x, y });
    let Some(mut chart) = layout.and_then(Chart::new) else { return no_data(title) };
    let [x, _] = chart.axes();
    let zero = [[x.range[0], 0.0], [x.range[1], 0.0]];
    if scales[1] == AxisScale::Linear && chart.contains(zero[0]) {
        chart.curve(&zero, &format!(r#"stroke="{INK}" stroke-width=".8""#));
    }
    for band in bands {
        let points: Vec<usize> = (0..band.at.len())
            .filter(|k| fits([band.at[*k], band.low[*k]]) && fits([band.at[*k], band.high[*k]]))
            .collect();
        for (name, values) in [("low", band.low), ("median", band.median), ("high", band.high)] {
            let all = points.iter().map(|k| [band.at[*k], values[*k]]);
            chart.record(&format!("{}, {name}", band.label), all);
        }
        let along = |values: &[f64]| -> Vec<[f64; 2]> {
            points.iter().map(|k| chart.to_pixel([band.at[*k], values[*k]])).collect()
        };
        let mut outline = along(band.high);
        outline.extend(along(band.low).into_iter().rev());
        let mut area = PathData::new();
        area.polygon(&outline);
        chart.svg.path(&area, &fill(band.colour));
        let middle: Vec<[f64; 2]> = points.iter().map(|k| [band.at[*k], band.median[*k]]).collect();
        chart.clipped_curve(&middle, &line(band.colour));
    }
    chart.record("measured", measured.iter().copied());
    let mut marks = PathData::new();
    for at in measured.iter().filter(|at| fits(**at)) {
        Marker::Circle.push(&mut marks, chart.to_pixel(*at), MARK);
    }
    chart.svg.path(&marks, &format!(r#"fill="{INK}""#));
    chart.frame();
    let mut key = vec![KeyEntry::new("measured", |svg, middle| {
        let mut mark = PathData::new();
        Marker::Circle.push(&mut mark, middle, MARK);
        svg.path(&mark, &format!(r#"fill="{INK}""#));
    })];
    key.extend(bands.iter().map(|band| KeyEntry::area(band.label, &fill(band.colour))));
    chart.finish_with_key(&key)
}

/// Half the size of a mark in pixels.
const MARK: f64 = 2.4;

fn fill(colour: &str) -> String {
    format!(r#"fill="{colour}" fill-opacity=".25" stroke="none""#)
}

fn line(colour: &str) -> String {
    format!(r#"stroke="{colour}" stroke-width="1.2" stroke-linejoin="round""#)
}
