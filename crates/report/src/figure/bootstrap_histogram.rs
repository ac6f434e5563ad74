//! Bootstrap estimates of one parameter with the intervals drawn from them.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, INK, VERMILLION};
use crate::histogram::Histogram;
use crate::key::KeyEntry;
use crate::numbers::{quantile, with_interval};
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::{label_with_unit, unit_text};

/// The line of the estimate.
const ESTIMATE: &str = r#"stroke-width="1.6""#;

/// Estimates of one parameter from resampled data, and the intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct BootstrapHistogram {
    /// Symbol or name of the parameter; `_x` sets a subscript.
    pub parameter: String,
    /// Unit as typed, empty if there is none.
    pub unit: String,
    /// One estimate per resample; not finite where the fit failed.
    pub estimates: Vec<f64>,
    /// The estimate from the data themselves.
    pub estimate: f64,
    /// 95 % interval of the fit, without the bootstrap.
    pub fitted: Option<[f64; 2]>,
    /// 95 % interval between percentiles of the estimates.
    pub percentile: Option<[f64; 2]>,
}

/// Histogram of the bootstrap estimates, with the estimate from the data, the interval of the fit
/// (solid) and the percentile interval (dashed) above it. The axis leaves out the farthest one
/// percent of the estimates; their number is stated.
#[must_use]
pub fn bootstrap_histogram(bootstrap: &BootstrapHistogram) -> String {
    let title = format!("bootstrap estimates of {}", bootstrap.parameter);
    let Some(bars) = bars(bootstrap) else {
        return no_data(&title);
    };
    let highest = bars.highest();
    let layout = ChartLayout {
        title: &title,
        size: [440.0, 300.0],
        left: 62.0,
        x: Axis::linear(&label_with_unit(&bootstrap.parameter, &bootstrap.unit), bars.range()),
        y: Axis::linear("number of resamples", [0.0, 1.3 * highest]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(&title);
    };
    bars.draw(&mut chart);
    let mut key = Vec::new();
    if chart.contains([bootstrap.estimate, 0.0]) {
        let ends = [[bootstrap.estimate, 0.0], [bootstrap.estimate, 1.3 * highest]];
        let style = format!(r#"stroke="{INK}" {ESTIMATE}"#);
        chart.curve(&ends, &style);
        key.push(KeyEntry::line("estimate", &style));
    }
    let unit = unit_text(&bootstrap.unit);
    for (interval, kind, height) in intervals(bootstrap)
        .into_iter()
        .zip([1.21, 1.11])
        .filter_map(|((interval, kind), height)| Some((interval?, kind, height * highest)))
    {
        let [from, to] = interval.map(|end| chart.to_pixel([end, height]));
        interval_mark(&mut chart.svg, [from, to], kind);
        let [_, low, high] = with_interval(bootstrap.estimate, interval);
        let label = format!("{} 95 %: {low} to {high} {unit}", kind.name());
        key.push(KeyEntry::new(label.trim_end(), |svg, [x, y]| {
            interval_mark(svg, [[x - 11.0, y], [x + 11.0, y]], kind);
        }));
    }
    note_outside(&mut chart, &bars);
    chart.frame();
    chart.finish_with_key(&key)
}

/// How an interval was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Normal,
    Percentile,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Normal => "fit",
            Self::Percentile => "percentile",
        }
    }

    fn style(self) -> String {
        match self {
            Self::Normal => format!(r#"stroke="{BLUE}" stroke-width="2""#),
            Self::Percentile => format!(r#"stroke="{VERMILLION}" stroke-width="2" stroke-dasharray="5 3""#),
        }
    }
}

/// The intervals that are known.
fn intervals(bootstrap: &BootstrapHistogram) -> [(Option<[f64; 2]>, Kind); 2] {
    let known = |interval: Option<[f64; 2]>| interval.filter(|ends| ends.iter().all(|end| end.is_finite()));
    [(known(bootstrap.fitted), Kind::Normal), (known(bootstrap.percentile), Kind::Percentile)]
}

/// The histogram over nearly all estimates, the estimate and its intervals.
fn bars(bootstrap: &BootstrapHistogram) -> Option<Histogram> {
    let values = || bootstrap.estimates.iter().copied();
    let ends = [quantile(values(), 0.005)?, quantile(values(), 0.995)?];
    let marks = intervals(bootstrap).into_iter().filter_map(|(interval, _)| interval).flatten();
    let marks: Vec<f64> = marks.chain(Some(bootstrap.estimate).filter(|value| value.is_finite())).collect();
    let low = marks.iter().copied().fold(ends[0], f64::min);
    let high = marks.iter().copied().fold(ends[1], f64::max);
    // Equal estimates still get a bar.
    let width = (high - low).max(1e-6 * low.abs().max(high.abs())).max(1e-12);
    let room = 0.04 * width;
    Histogram::new(values(), [low - room, low + width + room], 24)
}

fn interval_mark(svg: &mut Svg, [from, to]: [[f64; 2]; 2], kind: Kind) {
    let mut line = PathData::new();
    line.line(&[from, to]);
    svg.path(&line, &format!(r#"fill="none" {}"#, kind.style()));
    let mut caps = PathData::new();
    for [x, y] in [from, to] {
        caps.line(&[[x, y - 5.0], [x, y + 5.0]]);
    }
    svg.path(&caps, &format!(r#"fill="none" {}"#, kind.style().replace("5 3", "none")));
}

/// Says at the ends how many estimates lie beyond them, above the low bars there.
fn note_outside(chart: &mut Chart, bars: &Histogram) {
    let [[left, _], [right, _]] = chart.plot();
    let y = chart.to_pixel([bars.range()[0], 0.97 * bars.highest()])[1];
    let [below, above] = bars.outside;
    let notes = [(below, "◂ ", "", left + 5.0, Anchor::Start), (above, "", " ▸", right - 5.0, Anchor::End)];
    for (count, before, after, x, anchor) in notes.into_iter().filter(|note| note.0 > 0) {
        let text = format!("{before}{count} outside{after}");
        chart.svg.text_with_rim([x, y], &text, TextStyle::quiet(anchor), "#fff");
    }
}
