//! What the squared velocities are made of, as stacked bars.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREEN, VERMILLION};
use crate::discover_report::NoiseBudget;
use crate::key::KeyEntry;
use crate::map::hatch;
use crate::numbers::significant;
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Height of a bar's row in pixels.
const ROW: f64 = 46.0;
/// Least width in pixels of a part that carries its number.
const LEGIBLE: f64 = 32.0;

/// Shares of the squared velocities, one stacked bar for each model: explained by the base model, by
/// the added effects, noise of positions, noise of velocities, the rest. Parts that are negative or
/// not finite have no width.
#[must_use]
pub fn noise_budget(bars: &[(&str, NoiseBudget)]) -> String {
    let title = "what the squared velocities are made of";
    let total = |budget: &NoiseBudget| -> f64 { Part::ALL.iter().map(|part| part.share(budget)).sum() };
    let longest = bars.iter().map(|(_, budget)| total(budget)).fold(0.0, f64::max);
    if longest <= 0.0 {
        return no_data(title);
    }
    let count = bars.len() as f64;
    let layout = ChartLayout {
        title,
        size: [620.0, 54.0 + ROW * count],
        left: 132.0,
        x: Axis::linear("share of Σ|v|² (%)", [0.0, (100.0 * longest).max(100.0)]),
        y: Axis::linear("", [0.0, count]).without_ticks(),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    for (row, (label, budget)) in bars.iter().enumerate() {
        let middle = count - row as f64 - 0.5;
        let at = [chart.plot()[0][0] - 9.0, chart.to_pixel([0.0, middle])[1] + 4.0];
        chart.svg.text(at, label, TextStyle::label(Anchor::End));
        for part in Part::ALL.into_iter().filter(|part| part.share(budget) > 0.0) {
            chart.record(&format!("{label}, {}", part.name()), [[100.0 * part.share(budget), f64::NAN]]);
        }
        draw_bar(&mut chart, budget, middle);
    }
    let shown = |part: &&Part| bars.iter().any(|(_, budget)| part.share(budget) > 0.0);
    let key: Vec<KeyEntry> = Part::ALL.iter().filter(shown).map(|part| part.entry()).collect();
    chart.finish_with_key(&key)
}

fn draw_bar(chart: &mut Chart, budget: &NoiseBudget, middle: f64) {
    let mut start = 0.0;
    for part in Part::ALL {
        let share = 100.0 * part.share(budget);
        let corners = [chart.to_pixel([start, middle + 0.3]), chart.to_pixel([start + share, middle - 0.3])];
        part.fill(&mut chart.svg, corners);
        let width = corners[1][0] - corners[0][0];
        if width >= LEGIBLE {
            let at = [(corners[0][0] + corners[1][0]) / 2.0, chart.to_pixel([0.0, middle])[1] + 4.0];
            let (colour, rim) = part.ink();
            let style = TextStyle { colour, ..TextStyle::label(Anchor::Middle) };
            chart.svg.text_with_rim(at, &format!("{} %", significant(share, 2)), style, rim);
        }
        start += share;
    }
}

/// One part of a bar, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Base,
    Effects,
    PositionNoise,
    VelocityNoise,
    Unexplained,
}

impl Part {
    const ALL: [Self; 5] =
        [Self::Base, Self::Effects, Self::PositionNoise, Self::VelocityNoise, Self::Unexplained];

    fn share(self, budget: &NoiseBudget) -> f64 {
        let share = match self {
            Self::Base => budget.base,
            Self::Effects => budget.effects,
            Self::PositionNoise => budget.position_noise,
            Self::VelocityNoise => budget.velocity_noise,
            Self::Unexplained => budget.unexplained,
        };
        if share.is_finite() { share.max(0.0) } else { 0.0 }
    }

    fn colour(self) -> &'static str {
        match self {
            Self::Base => BLUE,
            Self::Effects => GREEN,
            Self::PositionNoise => "#d3d8dc",
            Self::VelocityNoise => "#a3abb2",
            Self::Unexplained => "#fff",
        }
    }

    /// Colours of a number on it and of the rim of that number.
    fn ink(self) -> (&'static str, &'static str) {
        match self {
            Self::Base | Self::Effects => ("#fff", self.colour()),
            _ => ("#222", self.colour()),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Base => "base model",
            Self::Effects => "added effects",
            Self::PositionNoise => "noise of positions",
            Self::VelocityNoise => "noise of velocities",
            Self::Unexplained => "unexplained",
        }
    }

    /// Fills a rectangle given by two opposite corners in pixels.
    fn fill(self, svg: &mut Svg, [from, to]: [[f64; 2]; 2]) {
        let mut area = PathData::new();
        area.rectangle(from, to);
        let stroke = if self == Self::Unexplained { VERMILLION } else { "#fff" };
        if to[0] > from[0] {
            svg.path(&area, &format!(r#"fill="{}" stroke="{stroke}" stroke-width=".9""#, self.colour()));
        }
        if self == Self::Unexplained {
            let mut lines = PathData::new();
            hatch(&mut lines, &[from, [to[0], from[1]], to, [from[0], to[1]]]);
            svg.path(&lines, &format!(r#"fill="none" stroke="{VERMILLION}" stroke-width="1.1""#));
        }
    }

    fn entry(self) -> KeyEntry {
        KeyEntry::new(self.name(), |svg, _| self.fill(svg, [[1.0, 1.5], [25.0, 12.5]]))
    }
}
