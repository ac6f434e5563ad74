//! Where cells went: beside each other what was seen and what models make of it.

use super::no_data;
use crate::colour::{BLUE, INK};
use crate::numbers::{nice_below, significant};
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::unit_text;

/// The ways of the cells of one movie.
#[derive(Debug, Clone, PartialEq)]
pub struct Trails<'a> {
    /// Name, above it.
    pub label: &'a str,
    /// Of each cell, its places in the frames that follow each other.
    pub ways: &'a [Vec<[f64; 2]>],
}

/// Width of a panel, and of the gap between two.
const PANEL: f64 = 300.0;
const GAP: f64 = 14.0;
/// Height of a line of text.
const LINE: f64 = 22.0;

/// The ways of cells in panels of one scale, beside each other; a dot where each ends. `unit` is that of lengths.
#[must_use]
pub fn trails(title: &str, panels: &[Trails<'_>], unit: &str) -> String {
    let places = || panels.iter().flat_map(|panel| panel.ways.iter().flatten());
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for at in places() {
        for (axis, end) in ends.iter_mut().enumerate() {
            *end = [end[0].min(at[axis]), end[1].max(at[axis])];
        }
    }
    let [width, height] = ends.map(|[low, high]| high - low);
    if !(width > 0.0 && height > 0.0) {
        return no_data(title);
    }
    let scale = PANEL / width.max(height);
    let size = [width * scale, height * scale];
    let count = panels.len() as f64;
    let mut svg = Svg::new([count * size[0] + (count - 1.0) * GAP, size[1] + 2.0 * LINE], title);
    for (k, panel) in panels.iter().enumerate() {
        let left = k as f64 * (size[0] + GAP);
        let place =
            |at: &[f64; 2]| [left + (at[0] - ends[0][0]) * scale, LINE + (ends[1][1] - at[1]) * scale];
        svg.text([left, LINE - 7.0], panel.label, TextStyle::label(Anchor::Start));
        let (mut lines, mut dots) = (PathData::new(), PathData::new());
        for way in panel.ways {
            let points: Vec<[f64; 2]> = way.iter().map(place).collect();
            lines.line(&points);
            if let Some(last) = points.last() {
                dots.dot(*last);
            }
        }
        let thin = r#"stroke-width=".9" stroke-linejoin="round" stroke-linecap="round""#;
        svg.path(&lines, &format!(r#"fill="none" stroke="{BLUE}" {thin}"#));
        svg.path(&dots, &format!(r#"fill="none" stroke="{INK}" stroke-width="2" stroke-linecap="round""#));
        let mut frame = PathData::new();
        frame.rectangle([left, LINE], [left + size[0], LINE + size[1]]);
        svg.path(&frame, r##"fill="none" stroke="#b8b8b8" stroke-width=".8""##);
    }
    let Some(bar) = nice_below(0.3 * width) else { return svg.finish() };
    let below = size[1] + 1.5 * LINE;
    let mut line = PathData::new();
    line.line(&[[2.0, below], [2.0 + bar * scale, below]]);
    svg.path(&line, &format!(r#"fill="none" stroke="{INK}" stroke-width="2""#));
    let told = format!("{} {}", significant(bar, 3), unit_text(unit));
    svg.text([8.0 + bar * scale, below + 4.0], &told, TextStyle::label(Anchor::Start));
    svg.finish()
}
