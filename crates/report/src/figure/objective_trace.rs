//! The penalised objective against the iteration.

use super::no_data;
use crate::chart::{Axis, Chart, ChartLayout};
use crate::colour::{BLUE, GREY};
use crate::numbers::significant;
use crate::svg::{Anchor, PathData, TextStyle};

/// The course of a fit.
#[derive(Debug, Clone, Copy)]
pub struct ObjectiveTrace<'a> {
    /// Objective after each iteration, the first entry being the start.
    pub values: &'a [f64],
    /// What a good fit is expected to reach (data minus parameters).
    pub expected: Option<f64>,
}

/// Objective against iteration on a logarithmic axis, with its expected value dashed. Values that
/// are not positive are skipped.
#[must_use]
pub fn objective_trace(trace: &ObjectiveTrace<'_>) -> String {
    let title = "objective against iteration";
    let positive = |value: &f64| value.is_finite() && *value > 0.0;
    let points: Vec<[f64; 2]> = trace
        .values
        .iter()
        .enumerate()
        .filter(|(_, value)| positive(value))
        .map(|(iteration, &value)| [iteration as f64, value])
        .collect();
    let expected = trace.expected.filter(positive);
    let all = || points.iter().map(|point| point[1]).chain(expected);
    let low = all().fold(f64::INFINITY, f64::min);
    let high = all().fold(0.0, f64::max);
    if points.is_empty() {
        return no_data(title);
    }
    let room = (high / low).powf(0.08).max(1.3);
    let last = points.last().map_or(1.0, |point| point[0]).max(1.0);
    let layout = ChartLayout {
        title,
        size: [440.0, 280.0],
        left: 66.0,
        x: Axis::linear("iteration", [-0.02 * last, 1.02 * last]),
        y: Axis::logarithmic("penalised objective", [low / room, high * room]),
    };
    let Some(mut chart) = Chart::new(layout) else {
        return no_data(title);
    };
    let [[left, _], _] = chart.plot();
    if let Some(expected) = expected {
        let ends = [[-0.02 * last, expected], [1.02 * last, expected]];
        chart.curve(&ends, &format!(r#"stroke="{GREY}" stroke-width="1.2" stroke-dasharray="5 3""#));
        let at = [left + 8.0, chart.to_pixel([0.0, expected])[1] - 5.0];
        let label = format!("expected {}", significant(expected, 3));
        chart.svg.text(at, &label, TextStyle::quiet(Anchor::Start));
    }
    chart.record("objective", points.iter().copied());
    chart.curve(&points, &format!(r#"stroke="{BLUE}" stroke-width="1.6" stroke-linejoin="round""#));
    if points.len() <= 60 {
        let mut dots = PathData::new();
        for &point in &points {
            dots.dot(chart.to_pixel(point));
        }
        let style = r#"fill="none" stroke-width="4.5" stroke-linecap="round""#;
        chart.svg.path(&dots, &format!(r#"stroke="{BLUE}" {style}"#));
    }
    chart.finish()
}
