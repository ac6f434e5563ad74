//! Velocities of many parameters on scaled axes.

use super::no_data;
use super::phase_map::row_colours;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::key::KeyEntry;
use crate::markers::Marker;
use crate::svg::{PathData, Svg};

/// Scaled points of one chirality.
#[derive(Debug, Clone, PartialEq)]
pub struct CollapseRow {
    /// Its name in the key.
    pub label: String,
    /// Argument and value in the liquid.
    pub liquid: Vec<[f64; 2]>,
    /// Argument and value in the solid.
    pub solid: Vec<[f64; 2]>,
}

/// Scaled velocities on logarithmic axes: circles in the liquid, open squares in the solid, a colour for each chirality. Where
/// the scaling holds, each side lies on one curve.
#[must_use]
pub fn collapse(title: &str, [x_label, y_label]: [&str; 2], rows: &[CollapseRow]) -> String {
    let all = || rows.iter().flat_map(|row| row.liquid.iter().chain(&row.solid));
    let fits = |point: &&[f64; 2]| point.iter().all(|&x| x.is_finite() && x > 0.0);
    let axis = |which: usize, label: &str| {
        let [low, high] = all().filter(fits).fold([f64::INFINITY, 0.0f64], |[low, high], point| {
            [low.min(point[which]), high.max(point[which])]
        });
        let room = (high / low).powf(0.04).max(1.3);
        Axis::logarithmic(label, [low / room, high * room])
    };
    let layout =
        ChartLayout { title, size: [470.0, 360.0], left: 76.0, x: axis(0, x_label), y: axis(1, y_label) };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    let mut key = vec![
        KeyEntry::new("P_0 > P_0*", |svg, at| liquid_mark(svg, &[at], "#555")),
        KeyEntry::new("P_0 < P_0*", |svg, at| solid_mark(svg, &[at], "#555")),
    ];
    for (row, colour) in rows.iter().zip(row_colours(rows.len())) {
        for (points, side) in [(&row.liquid, "P_0 > P_0*"), (&row.solid, "P_0 < P_0*")] {
            chart.record(&format!("{}, {side}", row.label), points.iter().copied());
        }
        let place = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            points.iter().filter(fits).map(|&point| chart.to_pixel(point)).collect()
        };
        let (liquid, solid) = (place(&row.liquid), place(&row.solid));
        solid_mark(&mut chart.svg, &solid, &colour);
        liquid_mark(&mut chart.svg, &liquid, &colour);
        key.push(KeyEntry::new(&row.label, |svg, at| liquid_mark(svg, &[at], &colour)));
    }
    chart.frame();
    chart.finish_with_key(&key)
}

fn liquid_mark(svg: &mut Svg, places: &[[f64; 2]], colour: &str) {
    let mut path = PathData::new();
    places.iter().for_each(|&at| Marker::Circle.push(&mut path, at, 3.0));
    svg.path(&path, &format!(r##"fill="{colour}" stroke="#fff" stroke-width=".6""##));
}

fn solid_mark(svg: &mut Svg, places: &[[f64; 2]], colour: &str) {
    let mut path = PathData::new();
    places.iter().for_each(|&at| Marker::Square.push(&mut path, at, 2.8));
    svg.path(&path, &format!(r#"fill="none" stroke="{colour}" stroke-width="1.2""#));
}
