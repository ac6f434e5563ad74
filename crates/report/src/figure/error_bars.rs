//! Horizontal bars of the normalised error of several predictions.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::BLUE;
use crate::key::KeyEntry;
use crate::numbers::significant;
use crate::series::ErrorPoint;
use crate::svg::{Anchor, PathData, TextStyle};

/// Bars end here however large the error is; the number tells.
const LONGEST: f64 = 2.5;
/// A number to quote, or what noise leaves, that is smaller than this share of the axis is told apart from others on a logarithmic one only.
const SMALL: f64 = 0.04;
/// The least that a logarithmic axis shows.
const LEAST: f64 = 1e-6;
/// Height of a bar's row in pixels.
const ROW: f64 = 34.0;

/// The line at what noise alone leaves.
const FLOOR: &str = r##"stroke="#d55e00" stroke-width="1.8""##;

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBar {
    /// What was predicted and how.
    pub label: String,
    /// Normalised mean square error; 0 perfect, 1 predicts nothing.
    pub nmse: f64,
    /// Standard error, drawn as a whisker.
    pub standard_error: Option<f64>,
    /// How much weight the bar has.
    pub emphasis: Emphasis,
}

/// How much weight a bar has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Emphasis {
    /// The number to quote.
    Main,
    /// For comparison.
    Quiet,
}

/// NMSE bars with their numbers; a line at 1 marks a model that predicts nothing. Bars that are not
/// finite are left out. Where those to quote are hardly to be seen the axis is logarithmic, and points stand for bars.
#[must_use]
pub fn error_bars(bars: &[ErrorBar]) -> String {
    error_bars_with_floor(bars, None)
}

/// [`error_bars`] with a line at what measurement noise alone leaves (`floor`, where it is finite):
/// no model gets below it.
#[must_use]
pub fn error_bars_with_floor(bars: &[ErrorBar], floor: Option<f64>) -> String {
    let title = "normalised mean square error";
    let bars: Vec<&ErrorBar> = bars.iter().filter(|bar| bar.nmse.is_finite()).collect();
    let longest = bars.iter().map(|bar| bar.nmse).fold(0.0, f64::max);
    if bars.is_empty() {
        return no_data(title);
    }
    let end = (longest * 1.12).clamp(1.15, LONGEST);
    let count = bars.len() as f64;
    let least = |errors: &mut dyn Iterator<Item = f64>| errors.filter(|x| *x > 0.0).fold(end, f64::min);
    let quoted = bars.iter().filter(|bar| bar.emphasis == Emphasis::Main).map(|bar| bar.nmse);
    let is_small = least(&mut quoted.chain(floor)) < SMALL * end;
    let least = least(&mut bars.iter().map(|bar| bar.nmse).chain(floor));
    let (x, range) = match is_small {
        true => {
            let range = [(0.4 * least).max(LEAST), 2.5 * end];
            (Axis::logarithmic("NMSE (1: predicts nothing), logarithmic", range), range)
        }
        false => (Axis::linear("NMSE (0: perfect, 1: predicts nothing)", [0.0, end]), [0.0, end]),
    };
    let layout = ChartLayout {
        title,
        size: [440.0, 56.0 + 14.0 + ROW * count],
        left: 158.0,
        x,
        y: Axis::linear("", [0.0, count]).without_ticks(),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    let middle = |row: usize| count - row as f64 - 0.5;
    for (row, bar) in bars.iter().enumerate() {
        chart
            .record(&bar.label, [ErrorPoint { at: [bar.nmse, f64::NAN], error: [bar.standard_error, None] }]);
        draw_bar(&mut chart, bar, (middle(row), range));
    }
    let ends = [[1.0, 0.0], [1.0, count]];
    chart.curve(&ends, r##"stroke="#222" stroke-width="1.2" stroke-dasharray="5 3""##);
    let floor = floor.filter(|&floor| chart.contains([floor, 0.0]));
    if let Some(floor) = floor {
        chart.curve(&[[floor, 0.0], [floor, count]], FLOOR);
    }
    for (row, bar) in bars.iter().enumerate() {
        draw_number(&mut chart, bar, (middle(row), range));
    }
    let label = |floor: f64| format!("noise alone: {}", significant(floor, 2));
    let key: Vec<KeyEntry> = floor.map(|floor| KeyEntry::line(&label(floor), FLOOR)).into_iter().collect();
    chart.finish_with_key(&key)
}

fn draw_bar(chart: &mut Chart, bar: &ErrorBar, (middle, [start, end]): (f64, [f64; 2])) {
    let fill = match bar.emphasis {
        Emphasis::Main => BLUE,
        Emphasis::Quiet => "#a9b8c4",
    };
    let reach = bar.nmse.clamp(start, end);
    if start > 0.0 {
        // Nothing begins at nought here, so lengths say nothing.
        let stem = [[start, middle], [reach, middle]];
        chart.curve(&stem, &format!(r#"stroke="{fill}" stroke-width="1.2" stroke-dasharray="2 3""#));
        let mut point = PathData::new();
        point.dot(chart.to_pixel([reach, middle]));
        chart.svg.path(&point, &format!(r#"stroke="{fill}" stroke-width="11" stroke-linecap="round""#));
    } else {
        let mut path = PathData::new();
        let [from, to] = [chart.to_pixel([0.0, middle + 0.3]), chart.to_pixel([reach, middle - 0.3])];
        path.rectangle(from, to);
        chart.svg.path(&path, &format!(r#"fill="{fill}""#));
    }
    if let Some([low, high]) = whisker(bar, [start, end]) {
        chart.curve(&[[low, middle], [high, middle]], r##"stroke="#222" stroke-width="1.4""##);
    }
    let at = [chart.plot()[0][0] - 9.0, chart.to_pixel([start, middle])[1] + 4.0];
    chart.svg.text(at, &bar.label, TextStyle::label(Anchor::End));
}

/// Prints the number behind the bar, or inside it where there is no room or the line at 1 is in the
/// way.
fn draw_number(chart: &mut Chart, bar: &ErrorBar, (middle, [start, end]): (f64, [f64; 2])) {
    let reach = bar.nmse.clamp(start, end);
    let [low, high] = whisker(bar, [start, end]).unwrap_or([reach; 2]);
    let mut number = significant(bar.nmse, 2);
    if let Some(half) = half(bar) {
        number.push_str(&format!(" ± {}", significant(half, 1)));
    }
    if bar.nmse > end {
        number.push_str(" ▸");
    } else if bar.nmse < start {
        number.insert_str(0, "◂ ");
    }
    let baseline = chart.to_pixel([start, middle])[1] + 4.0;
    let [[left, _], [right, _]] = chart.plot();
    let width = 6.3 * number.chars().count() as f64;
    let outside = chart.to_pixel([high, middle])[0] + 9.0;
    let inside = chart.to_pixel([low, middle])[0] - 9.0;
    let one = chart.to_pixel([1.0, middle])[0];
    let is_blocked = outside + width > right || (outside - 4.0..outside + width + 4.0).contains(&one);
    let (x, anchor, colour) = if is_blocked && inside - width > left {
        (inside, Anchor::End, if start > 0.0 { "#222" } else { contrast(bar.emphasis) })
    } else {
        (outside, Anchor::Start, "#222")
    };
    let style = TextStyle { size: TextStyle::LABEL, colour, anchor };
    match start > 0.0 {
        // Over the stem.
        true => chart.svg.text_with_rim([x, baseline], &number, style, "#fff"),
        false => chart.svg.text([x, baseline], &number, style),
    }
}

/// The standard error, where there is one.
fn half(bar: &ErrorBar) -> Option<f64> {
    bar.standard_error.filter(|half| half.is_finite() && *half > 0.0)
}

/// From one standard error below to one above, as far as the axis shows it.
fn whisker(bar: &ErrorBar, [start, end]: [f64; 2]) -> Option<[f64; 2]> {
    half(bar).map(|half| [bar.nmse - half, bar.nmse + half].map(|x| x.clamp(start, end)))
}

fn contrast(emphasis: Emphasis) -> &'static str {
    match emphasis {
        Emphasis::Main => "#fff",
        Emphasis::Quiet => "#222",
    }
}
