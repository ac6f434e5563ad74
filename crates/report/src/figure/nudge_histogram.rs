//! How large the nudges are, against what the assumed position noise would give.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::VERMILLION;
use crate::histogram::Histogram;
use crate::numbers::{quantile, significant};
use crate::svg::{Anchor, TextStyle};
use crate::view::{FrameView, length};

/// The nudges and the noise that was assumed, both in units of the cell size ℓ₀.
#[derive(Debug, Clone, PartialEq)]
pub struct NudgeHistogram {
    /// |nudge|/ℓ₀ of the used cells.
    pub sizes: Vec<f64>,
    /// Assumed standard deviation of the position noise per component, over ℓ₀.
    pub sigma_r: f64,
}

impl NudgeHistogram {
    /// The nudges of the used cells of some frames.
    #[must_use]
    pub fn new(frames: &[FrameView], length_scale: f64, sigma_r: f64) -> Self {
        let cells = frames.iter().flat_map(|frame| &frame.cells).filter(|cell| cell.is_used());
        Self { sizes: cells.map(|cell| length(cell.nudge) / length_scale).collect(), sigma_r }
    }
}

/// Histogram of |nudge|/ℓ₀ with the Rayleigh distribution `(x/σ²) exp(−x²/2σ²)` of the assumed
/// noise. Fitted nudges are smaller than the noise where the data hardly determine them.
#[must_use]
pub fn nudge_histogram(histogram: &NudgeHistogram) -> String {
    let title = "size of the nudges";
    let sigma = Some(histogram.sigma_r).filter(|sigma| sigma.is_finite() && *sigma > 0.0);
    let largest = quantile(histogram.sizes.iter().copied(), 0.99).unwrap_or(0.0);
    let end = largest.max(sigma.map_or(0.0, |sigma| 3.4 * sigma));
    let Some(bars) = Histogram::new(histogram.sizes.iter().copied(), [0.0, end], 14) else {
        return no_data(title);
    };
    let end = bars.range()[1];
    let curve: Vec<[f64; 2]> = sigma.map_or_else(Vec::new, |sigma| {
        let density = |x: f64| x / (sigma * sigma) * (-x * x / (2.0 * sigma * sigma)).exp();
        let at = |step: usize| end * step as f64 / 150.0;
        (0..=150).map(|step| [at(step), bars.total() * bars.width() * density(at(step))]).collect()
    });
    let highest = curve.iter().map(|point| point[1]).fold(bars.highest(), f64::max);
    let layout = ChartLayout {
        title,
        size: [440.0, 300.0],
        left: 62.0,
        x: Axis::linear("size of the nudge |ε| / ℓ₀", [0.0, end]),
        y: Axis::linear("number of cells", [0.0, 1.1 * highest]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    bars.draw(&mut chart);
    chart.record("position noise", curve.iter().copied());
    chart.curve(&curve, &format!(r#"stroke="{VERMILLION}" stroke-width="1.8""#));
    legend(&mut chart, sigma, bars.outside[1]);
    chart.finish()
}

fn legend(chart: &mut Chart, sigma: Option<f64>, beyond: usize) {
    let [[_, top], [right, _]] = chart.plot();
    let mut line = top + 16.0;
    let mut entry = |chart: &mut Chart, text: &str, style: TextStyle| {
        chart.svg.text([right - 8.0, line], text, style);
        line += 16.0;
    };
    if let Some(sigma) = sigma {
        let text = format!("— assumed noise, σ_r = {} ℓ₀", significant(sigma, 2));
        let style = TextStyle { colour: VERMILLION, ..TextStyle::label(Anchor::End) };
        entry(chart, &text, style);
    }
    if beyond > 0 {
        let text = format!("{beyond} larger than shown");
        entry(chart, &text, TextStyle::quiet(Anchor::End));
    }
}
