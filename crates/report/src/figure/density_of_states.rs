//! How many modes have which rate or frequency.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::histogram::Histogram;
use crate::numbers::quantile;
use crate::svg::{Anchor, TextStyle};
use crate::units::label_with_unit;

/// Histogram of a quantity of the modes, as a share of all modes per unit of it. The axis leaves out the farthest percent;
/// their number is stated.
#[must_use]
pub fn density_of_states(title: &str, quantity: &str, unit: &str, values: &[f64]) -> String {
    let ends = |low: f64, high: f64| {
        Some([quantile(values.iter().copied(), low)?, quantile(values.iter().copied(), high)?])
    };
    let few = values.len() < 100;
    let Some([low, high]) = ends(if few { 0.0 } else { 0.01 }, if few { 1.0 } else { 0.995 }) else {
        return no_data(title);
    };
    let width = (high - low).max(1e-6 * high.abs().max(low.abs())).max(1e-12);
    let bins = Histogram::bins(values.len(), 36);
    let Some(mut bars) = Histogram::new(values.iter().copied(), [low, low + 1.0001 * width], bins) else {
        return no_data(title);
    };
    let total = bars.total() * bars.width();
    bars.counts.iter_mut().for_each(|count| *count /= total);
    let highest = bars.counts.iter().copied().fold(0.0, f64::max);
    let layout = ChartLayout {
        title,
        size: [440.0, 270.0],
        left: 66.0,
        x: Axis::linear(&label_with_unit(quantity, unit), bars.range()),
        y: Axis::linear("density of states", [0.0, 1.08 * highest]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    bars.draw(&mut chart);
    let outside: usize = bars.outside.iter().sum();
    if outside > 0 {
        let [[left, top], _] = chart.plot();
        let text = format!("{outside} outside the axis");
        chart.svg.text_with_rim([left + 8.0, top + 15.0], &text, TextStyle::quiet(Anchor::Start), "#fff");
    }
    chart.frame();
    chart.finish()
}
