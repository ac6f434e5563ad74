//! How a number is distributed over cells.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::INK;
use crate::histogram::Histogram;
use crate::key::KeyEntry;
use crate::numbers::quantile;
use crate::svg::{Anchor, TextStyle};

/// A value to compare a distribution with.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmark {
    /// What it is.
    pub label: String,
    /// Where it lies.
    pub value: f64,
}

/// Histogram of a number over cells as a probability density, with a line at a value to compare with. The axis leaves out the
/// farthest percent of more than a hundred values; their number is stated.
#[must_use]
pub fn distribution(title: &str, label: &str, values: &[f64], landmark: Option<&Landmark>) -> String {
    let few = values.len() < 100;
    let ends = |low: f64, high: f64| {
        let mark = landmark.map(|mark| mark.value).filter(|value| value.is_finite());
        let [low, high] = [quantile(values.iter().copied(), low)?, quantile(values.iter().copied(), high)?];
        Some([mark.map_or(low, |mark| mark.min(low)), mark.map_or(high, |mark| mark.max(high))])
    };
    let Some([low, high]) = ends(if few { 0.0 } else { 0.005 }, if few { 1.0 } else { 0.995 }) else {
        return no_data(title);
    };
    let width = (high - low).max(1e-6 * high.abs().max(low.abs())).max(1e-12);
    let bins = Histogram::bins(values.len(), 28);
    let Some(mut bars) = Histogram::new(values.iter().copied(), [low, low + 1.0001 * width], bins) else {
        return no_data(title);
    };
    let total = bars.total() * bars.width();
    bars.counts.iter_mut().for_each(|count| *count /= total);
    let highest = bars.counts.iter().copied().fold(0.0, f64::max);
    let layout = ChartLayout {
        title,
        size: [440.0, 290.0],
        left: 62.0,
        x: Axis::linear(label, bars.range()),
        y: Axis::linear("probability density", [0.0, 1.08 * highest]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    bars.draw(&mut chart);
    let mut key = Vec::new();
    if let Some(mark) = landmark {
        let style = format!(r#"stroke="{INK}" stroke-width="1.4" stroke-dasharray="5 3""#);
        chart.clipped_curve(&[[mark.value, 0.0], [mark.value, 1.08 * highest]], &style);
        chart.record(&mark.label, [[mark.value, f64::NAN]]);
        key.push(KeyEntry::line(&mark.label, &style));
    }
    let outside: usize = bars.outside.iter().sum();
    if outside > 0 {
        let [[_, top], [right, _]] = chart.plot();
        let text = format!("{outside} outside the axis");
        chart.svg.text_with_rim([right - 8.0, top + 15.0], &text, TextStyle::quiet(Anchor::End), "#fff");
    }
    chart.frame();
    chart.finish_with_key(&key)
}
