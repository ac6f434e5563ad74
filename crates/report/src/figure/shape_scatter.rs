//! Voronoi areas or perimeters against the true ones.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, INK};
use crate::numbers::{quantile, significant};
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::Units;
use crate::units::label_with_unit;

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeMeasure {
    /// Areas.
    Area,
    /// Perimeters.
    Perimeter,
}

/// Voronoi against true measure of each cell, `[true, Voronoi]`, with the line of equality and the correlation given. The axes cover
/// 99.5 % of the values; how many lie outside is said.
#[must_use]
pub fn shape_scatter(pairs: &[[f64; 2]], measure: ShapeMeasure, correlation: f64, units: &Units) -> String {
    let (title, name, power) = match measure {
        ShapeMeasure::Area => ("Voronoi against true areas", "area", 2),
        ShapeMeasure::Perimeter => ("Voronoi against true perimeters", "perimeter", 1),
    };
    let Some(most) = quantile(pairs.iter().flatten().copied(), 0.995).filter(|&most| most > 0.0) else {
        return no_data(title);
    };
    let range = [0.0, 1.08 * most];
    let unit = units.powers(power, 0);
    let layout = ChartLayout {
        title,
        size: [400.0, 370.0],
        left: 66.0,
        x: Axis::linear(&label_with_unit(&format!("true {name}"), &unit), range),
        y: Axis::linear(&label_with_unit(&format!("Voronoi {name}"), &unit), range),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    chart.curve(
        &[[0.0, 0.0], [range[1]; 2]],
        &format!(r#"stroke="{INK}" stroke-width=".9" stroke-dasharray="4 3""#),
    );
    chart.record("cells", pairs.iter().copied());
    let (mut marks, mut outside) = (PathData::new(), 0);
    for &pair in pairs.iter().filter(|pair| pair.iter().all(|x| x.is_finite())) {
        if chart.contains(pair) {
            marks.dot(chart.to_pixel(pair));
        } else {
            outside += 1;
        }
    }
    let style =
        format!(r#"fill="none" stroke="{BLUE}" stroke-width="4" stroke-linecap="round" opacity=".55""#);
    chart.svg.path(&marks, &style);
    chart.frame();
    let [[left, top], [right, bottom]] = chart.plot();
    let text = format!("correlation {}", significant(correlation, 2));
    chart.svg.text([left + 10.0, top + 18.0], &text, TextStyle::label(Anchor::Start));
    if outside > 0 {
        let text = format!("{outside} outside the axes");
        chart.svg.text([right - 8.0, bottom - 8.0], &text, TextStyle::quiet(Anchor::End));
    }
    chart.finish()
}
