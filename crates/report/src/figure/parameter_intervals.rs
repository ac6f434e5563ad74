//! Parameters with their 95 % intervals, each on its own small axis.

use super::no_data;
use crate::colour::{BLUE, GREY, INK, VERMILLION};
use crate::numbers::{as_given, interval_text, significant, tick_labels, ticks};
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::unit_text;

/// Height of a row in pixels.
const ROW: f64 = 50.0;
/// Least distance of the small axes from the left, their length, and the room behind them, in pixels.
const LEFT: f64 = 86.0;
const AXIS: f64 = 306.0;
const RIGHT: f64 = 148.0;
/// About the width of a letter of a symbol in pixels.
const LETTER: f64 = 7.4;

/// Whether a parameter was fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimate {
    /// Fitted.
    Fitted,
    /// Fitted, and stopped by a bound of the values allowed.
    AtBound,
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
    /// 95 % interval, an end that is `None` being unbounded; none for a parameter held fixed.
    pub ci95: Option<[Option<f64>; 2]>,
    /// The value without nudges.
    pub naive: Option<f64>,
    /// Whether it was fitted.
    pub estimate: Estimate,
    /// What the parameter means, for a reader who does not know the model.
    pub meaning: String,
}

impl ParameterRow {
    /// The interval if the ends it has are finite.
    #[must_use]
    pub fn interval(&self) -> Option<[Option<f64>; 2]> {
        self.ci95.filter(|ends| ends.iter().flatten().all(|end| end.is_finite()))
    }
}

/// Point and 95 % interval per parameter, each row on its own axis, with the naive estimate beside
/// it and zero marked where the axis contains it. An interval without a bound runs to the end of the
/// axis with an arrow head; an estimate at a bound has a wall. Parameters without a finite value are
/// left out.
#[must_use]
pub fn parameter_intervals(rows: &[ParameterRow]) -> String {
    let title = "parameters with 95 % intervals";
    let rows: Vec<&ParameterRow> = rows.iter().filter(|row| row.value.is_finite()).collect();
    if rows.is_empty() {
        return no_data(title);
    }
    let longest = rows.iter().map(|row| row.symbol.chars().count()).max().unwrap_or(0);
    let left = LEFT.max(18.0 + LETTER * longest as f64);
    let axis = [left, left + AXIS];
    let mut svg = Svg::new([axis[1] + RIGHT, ROW * rows.len() as f64 + 30.0], title);
    legend(&mut svg, &rows, axis);
    for (index, row) in rows.iter().enumerate() {
        draw_row(&mut svg, row, (axis, 30.0 + ROW * index as f64));
    }
    svg.finish()
}

fn legend(svg: &mut Svg, rows: &[&ParameterRow], axis: [f64; 2]) {
    let (x, y) = (axis[0], 12.0);
    interval_mark(svg, [Some(x), Some(x + 24.0)], (axis, [x + 12.0, y]));
    svg.text([x + 31.0, y + 4.0], "nudged, 95 % interval", TextStyle::quiet(Anchor::Start));
    if rows.iter().any(|row| row.naive.is_some()) {
        cross(svg, [x + 176.0, y]);
        svg.text([x + 186.0, y + 4.0], "naive (no nudges)", TextStyle::quiet(Anchor::Start));
    }
}

fn draw_row(svg: &mut Svg, row: &ParameterRow, (ends, top): ([f64; 2], f64)) {
    let y = top + 14.0;
    let baseline = top + 26.0;
    let [left, right] = ends;
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
        naive_mark(svg, naive, (range, ends), [place(naive), y]);
    }
    let at = place(row.value);
    if row.estimate == Estimate::AtBound {
        wall(svg, [at, y]);
    }
    match row.interval() {
        Some(interval) => interval_mark(svg, interval.map(|end| end.map(place)), (ends, [at, y])),
        None => fixed_mark(svg, [at, y]),
    }
    svg.text([right + 12.0, y + 4.0], &value_text(row), TextStyle::label(Anchor::Start));
    let style = TextStyle { size: 10.0, ..TextStyle::quiet(Anchor::Start) };
    svg.text([right + 12.0, y + 18.0], &remark(row), style);
}

/// The interval (or the value) with room, zero if it is near, and the naive value unless it is far.
/// Where the interval has no bound, there is room for it to run on.
fn row_range(row: &ParameterRow) -> [f64; 2] {
    let ends = row.interval().unwrap_or([Some(row.value); 2]);
    let [low, high] = [ends[0].unwrap_or(row.value), ends[1].unwrap_or(row.value)];
    let [low, high] = [low.min(row.value), high.max(row.value)];
    let is_given = row.interval().is_some() && high > low;
    let size = [row.value.abs(), high - low, row.naive.unwrap_or(0.0).abs()];
    let size = size.into_iter().find(|&size| size > 0.0 && size.is_finite()).unwrap_or(1.0);
    let width = (high - low).max(if is_given { 1e-3 } else { 0.5 } * size);
    let run = |end: Option<f64>| if end.is_none() { 0.6 * width } else { 0.0 };
    let mut range = [low - run(ends[0]), high + run(ends[1])];
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

fn naive_mark(svg: &mut Svg, naive: f64, (range, axis): ([f64; 2], [f64; 2]), at: [f64; 2]) {
    let [left, right] = axis;
    if (range[0]..=range[1]).contains(&naive) {
        cross(svg, at);
        return;
    }
    let is_below = naive < range[0];
    let (x, sign) = if is_below { (left - 4.0, -1.0) } else { (right + 4.0, 1.0) };
    // Above the line of the interval, which may run to the end of the axis.
    let y = at[1] - 10.0;
    arrow_head(svg, [x, y], 7.0 * sign, VERMILLION);
    let anchor = if is_below { Anchor::Start } else { Anchor::End };
    let style = TextStyle { size: 10.0, colour: VERMILLION, anchor };
    svg.text_with_rim([x - sign * 11.0, y + 3.5], &significant(naive, 3), style, "#fff");
}

/// Draws a horizontal arrow head of the given length (negative to the left).
fn arrow_head(svg: &mut Svg, tip: [f64; 2], along: f64, colour: &str) {
    let back = tip[0] - along;
    let mut head = PathData::new();
    head.polygon(&[tip, [back, tip[1] - 4.0], [back, tip[1] + 4.0]]);
    svg.path(&head, &format!(r#"fill="{colour}""#));
}

/// Draws an interval whose ends stand at these places, none for an end without a bound.
fn interval_mark(svg: &mut Svg, ends: [Option<f64>; 2], (axis, [at, y]): ([f64; 2], [f64; 2])) {
    let mut line = PathData::new();
    let [low, high] = [ends[0].unwrap_or(axis[0] + 4.0), ends[1].unwrap_or(axis[1] - 4.0)];
    line.line(&[[low, y], [high, y]]);
    for end in ends.into_iter().flatten() {
        line.line(&[[end, y - 4.0], [end, y + 4.0]]);
    }
    svg.path(&line, &format!(r#"fill="none" stroke="{BLUE}" stroke-width="1.8""#));
    for (end, tip, along) in [(ends[0], axis[0], -8.0), (ends[1], axis[1], 8.0)] {
        if end.is_none() {
            arrow_head(svg, [tip, y], along, BLUE);
        }
    }
    let mut dot = PathData::new();
    dot.dot([at, y]);
    let style = r#"fill="none" stroke-width="8" stroke-linecap="round""#;
    svg.path(&dot, &format!(r#"stroke="{BLUE}" {style}"#));
}

/// Draws the bound at which an estimate stopped.
fn wall(svg: &mut Svg, [x, y]: [f64; 2]) {
    let mut line = PathData::new();
    line.line(&[[x, y - 10.0], [x, y + 10.0]]);
    svg.path(&line, &format!(r#"fill="none" stroke="{INK}" stroke-width="2.6""#));
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
        (Some(ends), _) => format!("{} {unit}", interval_text(row.value, ends)[0]),
        (None, Estimate::Fixed) => format!("{} (fixed)", as_given(row.value)),
        (None, _) => format!("{} {unit}", significant(row.value, 3)),
    }
}

/// What the picture of an interval cannot say by itself.
fn remark(row: &ParameterRow) -> String {
    let one_sided = row.interval().filter(|ends| ends.iter().any(Option::is_none));
    let bounds = one_sided.map(|ends| interval_text(row.value, ends)[1].clone());
    let bound = (row.estimate == Estimate::AtBound).then(|| "at a bound".to_owned());
    bounds.into_iter().chain(bound).collect::<Vec<_>>().join(", ")
}
