//! Parameters with their 95 % intervals, each on its own small axis.

use super::no_data;
use crate::colour::{BLUE, GREY, VERMILLION};
use crate::numbers::{as_given, significant, tick_labels, ticks, unit_text, with_interval};
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Height of a row in pixels.
const ROW: f64 = 50.0;
/// Left and right end of the small axes in pixels.
const AXIS: [f64; 2] = [86.0, 392.0];
/// Width of the figure in pixels.
const WIDTH: f64 = 540.0;

/// Whether a parameter was fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimate {
    /// Fitted.
    Fitted,
    /// Held at its value.
    Fixed,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRow {
    /// Symbol; `_x` sets a subscript, as in `K_P α`.
    pub symbol: String,
    /// Unit as typed, empty if there is none.
    pub unit: String,
    /// Fitted (nudged) value.
    pub value: f64,
    /// 95 % interval; none for a parameter held fixed.
    pub ci95: Option<[f64; 2]>,
    /// The value without nudges.
    pub naive: Option<f64>,
    /// Whether it was fitted.
    pub estimate: Estimate,
    /// What the parameter means, for a reader who does not know the model.
    pub meaning: String,
}

impl ParameterRow {
    /// The interval if both ends are finite.
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        self.ci95.filter(|ends| ends.iter().all(|end| end.is_finite()))
    }
}

/// Point and 95 % interval per parameter, each row on its own axis, with the naive estimate beside
/// it and zero marked where the axis contains it. Parameters without a finite value are left out.
#[must_use]
pub fn parameter_intervals(rows: &[ParameterRow]) -> String {
    let title = "parameters with 95 % intervals";
    let rows: Vec<&ParameterRow> = rows.iter().filter(|row| row.value.is_finite()).collect();
    if rows.is_empty() {
        return no_data(title);
    }
    let mut svg = Svg::new([WIDTH, ROW * rows.len() as f64 + 30.0], title);
    legend(&mut svg);
    for (index, row) in rows.iter().enumerate() {
        draw_row(&mut svg, row, 30.0 + ROW * index as f64);
    }
    svg.finish()
}

fn legend(svg: &mut Svg) {
    let y = 12.0;
    interval_mark(svg, [[86.0, y], [98.0, y], [110.0, y]]);
    svg.text([117.0, y + 4.0], "nudged, 95 % interval", TextStyle::quiet(Anchor::Start));
    cross(svg, [262.0, y]);
    svg.text([272.0, y + 4.0], "naive (no nudges)", TextStyle::quiet(Anchor::Start));
}

fn draw_row(svg: &mut Svg, row: &ParameterRow, top: f64) {
    let y = top + 14.0;
    let baseline = top + 26.0;
    let [left, right] = AXIS;
    let range = row_range(row);
    let place = |value: f64| left + (value - range[0]) / (range[1] - range[0]) * (right - left);
    let symbol = TextStyle { size: 14.0, ..TextStyle::label(Anchor::Start) };
    svg.text([6.0, y + 5.0], &row.symbol, symbol);
    let mut axis = PathData::new();
    axis.line(&[[left, baseline], [right, baseline]]);
    let mut positions = ticks(range, 5);
    if tick_labels(&positions).iter().any(|label| label.chars().count() > 6) {
        positions = ticks(range, 3);
    }
    for (&position, label) in positions.iter().zip(tick_labels(&positions)) {
        let x = place(position);
        axis.line(&[[x, baseline], [x, baseline + 3.5]]);
        let style = TextStyle { size: 10.0, ..TextStyle::quiet(Anchor::Middle) };
        svg.text([x, baseline + 13.5], &label, style);
    }
    svg.path(&axis, r##"fill="none" stroke="#aaa" stroke-width=".9""##);
    if range[0] <= 0.0 && 0.0 <= range[1] {
        let mut zero = PathData::new();
        zero.line(&[[place(0.0), baseline], [place(0.0), top + 2.0]]);
        svg.path(&zero, r##"fill="none" stroke="#222" stroke-width=".9" stroke-dasharray="3 2""##);
    }
    if let Some(naive) = row.naive.filter(|naive| naive.is_finite()) {
        naive_mark(svg, naive, (range, [place(naive), y]));
    }
    let at = place(row.value);
    match row.interval() {
        Some([low, high]) => interval_mark(svg, [[place(low), y], [at, y], [place(high), y]]),
        None => fixed_mark(svg, [at, y]),
    }
    svg.text([right + 12.0, y + 4.0], &value_text(row), TextStyle::label(Anchor::Start));
}

/// The interval (or the value) with room, zero if it is near, and the naive value unless it is far.
fn row_range(row: &ParameterRow) -> [f64; 2] {
    let [low, high] = row.interval().unwrap_or([row.value, row.value]);
    let [low, high] = [low.min(row.value), high.max(row.value)];
    let size = row.value.abs().max(1e-12);
    let width = (high - low).max(if row.interval().is_some() { 1e-3 } else { 0.5 } * size);
    let mut range = [low, high];
    let mut include = |value: f64, reach: f64| {
        if value.is_finite() && value > low - reach * width && value < high + reach * width {
            range = [range[0].min(value), range[1].max(value)];
        }
    };
    include(0.0, 1.5);
    include(row.naive.unwrap_or(f64::NAN), 8.0);
    let room = 0.12 * (range[1] - range[0]).max(width);
    [range[0] - room, range[1] + room]
}

fn naive_mark(svg: &mut Svg, naive: f64, (range, at): ([f64; 2], [f64; 2])) {
    let [left, right] = AXIS;
    if (range[0]..=range[1]).contains(&naive) {
        cross(svg, at);
        return;
    }
    let is_below = naive < range[0];
    let (x, sign) = if is_below { (left - 4.0, -1.0) } else { (right + 4.0, 1.0) };
    let mut arrow = PathData::new();
    let back = x - sign * 7.0;
    arrow.polygon(&[[x, at[1]], [back, at[1] - 4.0], [back, at[1] + 4.0]]);
    svg.path(&arrow, &format!(r#"fill="{VERMILLION}""#));
    let anchor = if is_below { Anchor::Start } else { Anchor::End };
    let style = TextStyle { size: 10.0, colour: VERMILLION, anchor };
    let label = significant(naive, 3);
    svg.text([back - sign * 4.0, at[1] - 5.0], &label, style);
}

fn interval_mark(svg: &mut Svg, [low, at, high]: [[f64; 2]; 3]) {
    let mut line = PathData::new();
    line.line(&[low, high]);
    for end in [low, high] {
        line.line(&[[end[0], end[1] - 4.0], [end[0], end[1] + 4.0]]);
    }
    svg.path(&line, &format!(r#"fill="none" stroke="{BLUE}" stroke-width="1.8""#));
    let mut dot = PathData::new();
    dot.dot(at);
    let style = r#"fill="none" stroke-width="8" stroke-linecap="round""#;
    svg.path(&dot, &format!(r#"stroke="{BLUE}" {style}"#));
}

fn fixed_mark(svg: &mut Svg, [x, y]: [f64; 2]) {
    let mut square = PathData::new();
    square.rectangle([x - 4.0, y - 4.0], [x + 4.0, y + 4.0]);
    svg.path(&square, &format!(r##"fill="#fff" stroke="{GREY}" stroke-width="1.6""##));
}

fn cross(svg: &mut Svg, [x, y]: [f64; 2]) {
    let mut lines = PathData::new();
    lines.line(&[[x - 4.0, y - 4.0], [x + 4.0, y + 4.0]]);
    lines.line(&[[x - 4.0, y + 4.0], [x + 4.0, y - 4.0]]);
    svg.path(&lines, &format!(r#"fill="none" stroke="{VERMILLION}" stroke-width="2""#));
}

fn value_text(row: &ParameterRow) -> String {
    let unit = unit_text(&row.unit);
    match (row.interval(), row.estimate) {
        (Some(ends), _) => format!("{} {unit}", with_interval(row.value, ends)[0]),
        (None, Estimate::Fitted) => format!("{} {unit}", significant(row.value, 3)),
        (None, Estimate::Fixed) => format!("{} (fixed)", as_given(row.value)),
    }
}
