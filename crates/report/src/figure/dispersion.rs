//! Rates of waves on a lattice along a path through the Brillouin zone.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREY, INK, VERMILLION};
use crate::key::KeyEntry;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::label_with_unit;

/// Waves at one point of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DispersionPoint {
    /// Length of the path up to here.
    pub distance: f64,
    /// Name, if it is a point of high symmetry.
    pub corner: Option<&'static str>,
    /// Decay rate and frequency of both waves from the Jacobian of the model.
    pub exact: [[f64; 2]; 2],
    /// The same of the theory, where there is one.
    pub theory: Option<[[f64; 2]; 2]>,
}

/// What is drawn against the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DispersionPart {
    /// The decay rate, negative where waves grow.
    Decay,
    /// The angular frequency.
    Frequency,
}

/// Both branches along the path: lines are the theory, marks the exact Jacobian of the model.
#[must_use]
pub fn dispersion(points: &[DispersionPoint], part: DispersionPart, unit: &str) -> String {
    let (title, label, which) = match part {
        DispersionPart::Decay => ("decay rates on the honeycomb", "decay rate", 0),
        DispersionPart::Frequency => ("frequencies on the honeycomb", "angular frequency", 1),
    };
    let values = || {
        points.iter().flat_map(|point| {
            point.exact.into_iter().chain(point.theory.into_iter().flatten()).map(move |wave| wave[which])
        })
    };
    let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
    let end = points.last().map_or(0.0, |point| point.distance);
    let room = if high > low { 0.06 * (high - low) } else { 1.0 };
    let layout = ChartLayout {
        title,
        size: [480.0, 330.0],
        left: 66.0,
        x: Axis::linear(" ", [0.0, end]).without_ticks(),
        y: Axis::linear(&label_with_unit(label, unit), [low - room, high + room]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    for point in points {
        let Some(corner) = point.corner else { continue };
        let line = [[point.distance, low - room], [point.distance, high + room]];
        chart.curve(&line, &format!(r#"stroke="{GREY}" stroke-width=".8""#));
        let [x, y] = chart.to_pixel(line[0]);
        let style = TextStyle { size: 13.0, ..TextStyle::label(Anchor::Middle) };
        chart.svg.text([x, y + 18.0], corner, style);
    }
    chart.curve(
        &[[0.0, 0.0], [end, 0.0]],
        &format!(r#"stroke="{INK}" stroke-width=".8" stroke-dasharray="3 3""#),
    );
    let line_style = format!(r#"stroke="{BLUE}" stroke-width="1.8" stroke-linejoin="round""#);
    for branch in 0..2 {
        let line: Vec<[f64; 2]> = points
            .iter()
            .map(|point| [point.distance, point.theory.map_or(f64::NAN, |waves| waves[branch][which])])
            .collect();
        if points.iter().any(|point| point.theory.is_some()) {
            chart.record(&format!("mean-field theory, branch {}", branch + 1), line.iter().copied());
        }
        chart.curve(&line, &line_style);
        let exact = points.iter().map(|point| [point.distance, point.exact[branch][which]]);
        chart.record(&format!("Jacobian of the model, branch {}", branch + 1), exact);
    }
    let mut marks = PathData::new();
    for point in points.iter().step_by((points.len() / 60).max(1)) {
        for wave in point.exact {
            circle(&mut marks, chart.to_pixel([point.distance, wave[which]]));
        }
    }
    let mark_style = format!(r#"fill="none" stroke="{VERMILLION}" stroke-width="1.1""#);
    chart.svg.path(&marks, &mark_style);
    chart.frame();
    let mut key = vec![KeyEntry::new("Jacobian of the model", |svg, at| {
        let mut mark = PathData::new();
        circle(&mut mark, at);
        svg.path(&mark, &mark_style);
    })];
    if points.iter().any(|point| point.theory.is_some()) {
        key.push(KeyEntry::line("mean-field theory", &line_style));
    }
    chart.finish_with_key(&key)
}

fn circle(path: &mut PathData, [x, y]: [f64; 2]) {
    crate::markers::Marker::Circle.push(path, [x, y], 2.6);
}
