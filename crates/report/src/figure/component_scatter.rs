//! The marks of charts that show both components of a vector against another: x as blue dots, y as
//! orange diamonds.

use crate::chart::Chart;
use crate::colour::{BLUE, VERMILLION};
use crate::svg::{Anchor, PathData, TextStyle};

/// Names of the components.
const COMPONENTS: [&str; 2] = ["x component", "y component"];
/// Marks are drawn in this many translucent layers, so that dense regions look dense.
const LAYERS: usize = 24;
/// Half the size of a mark in pixels.
const MARK: f64 = 1.9;

/// Draws the marks layer by layer; returns how many lie outside the axes.
pub(super) fn draw(chart: &mut Chart, components: [Vec<[f64; 2]>; 2]) -> usize {
    let mut layers = vec![[PathData::new(), PathData::new()]; LAYERS];
    let mut outside = 0;
    for (axis, points) in components.iter().enumerate() {
        chart.record(COMPONENTS[axis], points.iter().copied());
        for (index, &point) in points.iter().enumerate() {
            if !chart.contains(point) {
                outside += 1;
                continue;
            }
            let path = &mut layers[index % LAYERS][axis];
            push_mark(path, axis, chart.to_pixel(point));
        }
    }
    for [dots, diamonds] in &layers {
        chart.svg.path(dots, &mark_style(0));
        chart.svg.path(diamonds, &mark_style(1));
    }
    outside
}

fn push_mark(path: &mut PathData, axis: usize, at: [f64; 2]) {
    let [x, y] = at;
    if axis == 0 {
        path.dot(at);
    } else {
        let size = 1.2 * MARK;
        path.polygon(&[[x - size, y], [x, y - size], [x + size, y], [x, y + size]]);
    }
}

fn mark_style(axis: usize) -> String {
    if axis == 0 {
        let width = 2.0 * MARK;
        format!(r#"fill="none" stroke="{BLUE}" stroke-width="{width}" stroke-linecap="round" opacity=".5""#)
    } else {
        format!(r#"fill="{VERMILLION}" opacity=".5""#)
    }
}

/// Names the components in the upper left corner, and says on the line at `y` how many points lie
/// outside.
pub(super) fn annotate(chart: &mut Chart, outside: usize, y: f64) {
    let [[left, top], [right, _]] = chart.plot();
    for (axis, label) in COMPONENTS.into_iter().enumerate() {
        let y = top + 16.0 + 16.0 * axis as f64;
        let mut mark = PathData::new();
        push_mark(&mut mark, axis, [left + 14.0, y - 4.0]);
        chart.svg.path(&mark, &mark_style(axis));
        chart.svg.text([left + 24.0, y], label, TextStyle::label(Anchor::Start));
    }
    if outside > 0 {
        let noun = if outside == 1 { "point" } else { "points" };
        let text = format!("{outside} {noun} outside the axes");
        chart.svg.text([right - 10.0, y], &text, TextStyle::quiet(Anchor::End));
    }
}
