//! The horizontal bar that says which number a colour stands for.

use crate::colour::ColourScale;
use crate::numbers::Ticks;
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Where a colour bar stands and what it says.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourBar {
    /// Left and right end in pixels.
    pub ends: [f64; 2],
    /// Upper edge in pixels; the bar with its label is about 45 pixels high.
    pub top: f64,
    /// Positions on the colour scale and their labels.
    pub ticks: Vec<(f64, String)>,
    /// What the numbers mean, with unit.
    pub label: String,
}

impl ColourBar {
    /// A bar of colours that are spread evenly.
    #[must_use]
    pub fn linear(ends: [f64; 2], top: f64, colours: &ColourScale, label: &str) -> Self {
        let ticks = Ticks::new(colours.limits(), 5);
        Self { ends, top, label: ticks.axis_label(label), ticks: ticks.labelled() }
    }

    /// Draws the bar. Triangles at its ends say that some values lie beyond it.
    pub fn draw(&self, svg: &mut Svg, colours: &ColourScale) {
        let [left, right] = self.ends;
        let [top, bottom] = [self.top, self.top + 11.0];
        let width = (right - left) / ColourScale::LEVELS as f64;
        for level in 0..ColourScale::LEVELS {
            let x = left + level as f64 * width;
            let mut cell = PathData::new();
            // Half a pixel of overlap hides the seams between the classes.
            cell.rectangle([x, top], [(x + width + 0.5).min(right), bottom]);
            svg.path(&cell, &format!(r#"fill="{}""#, colours.colour(level)));
        }
        let middle = (top + bottom) / 2.0;
        let [below, above] = colours.extended();
        for (is_extended, x, tip, level) in
            [(below, left, left - 9.0, 0), (above, right, right + 9.0, ColourScale::LEVELS - 1)]
        {
            if is_extended {
                let mut triangle = PathData::new();
                triangle.polygon(&[[x, top], [tip, middle], [x, bottom]]);
                svg.path(&triangle, &format!(r#"fill="{}""#, colours.colour(level)));
            }
        }
        let [low, high] = colours.limits();
        for (position, text) in &self.ticks {
            let x = left + (position - low) / (high - low) * (right - left);
            let mut tick = PathData::new();
            tick.line(&[[x, bottom], [x, bottom + 3.5]]);
            svg.path(&tick, r##"fill="none" stroke="#222" stroke-width=".8""##);
            svg.text([x, bottom + 14.5], text, TextStyle::label(Anchor::Middle));
        }
        let at = [(left + right) / 2.0, bottom + 29.0];
        svg.text(at, &self.label, TextStyle::label(Anchor::Middle));
    }
}
