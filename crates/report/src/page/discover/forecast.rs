//! How well models say what the cells do next.

use serde::Serialize;

use super::super::Figure;
use super::super::words::with_error;
use crate::chart::AxisScale;
use crate::colour::{BLUE, GREEN, GREY, INK, VERMILLION};
use crate::discover_report::{ForecastReport, Gain};
use crate::figure::{ErrorPoint, PointSeries, PointsAndCurves, points_and_curves};
use crate::markers::Marker;
use crate::numbers::significant;
use crate::units::unit_text;

/// Least skill that is drawn: far below nought all are useless.
const LEAST: f64 = -0.5;

/// The section of the page.
#[derive(Serialize)]
pub(super) struct ForecastView {
    figures: Vec<Figure>,
    columns: Vec<String>,
    rows: Vec<(&'static str, Vec<String>)>,
    remark: String,
}

impl ForecastView {
    pub fn new(report: &ForecastReport) -> Self {
        let skills = |own: &[Gain]| own.iter().map(|own| with_error(own.value, own.standard_error)).collect();
        let mut rows: Vec<(&'static str, Vec<String>)> =
            report.skill.named().map(|(name, own)| (name, skills(own))).collect();
        if let Some(gain) = &report.gain {
            rows.push(("gain by the effects", skills(gain)));
        }
        rows.push(("best possible", report.best_possible.iter().map(|own| significant(*own, 3)).collect()));
        let error = |own: &f64| format!("{} {}", significant(*own, 3), unit_text(&report.unit));
        let model = report.error.extended.as_ref().unwrap_or(&report.error.base);
        let expected = report.expected_error.extended.as_ref().unwrap_or(&report.expected_error.base);
        let remark = match (model.first(), expected.first()) {
            (Some(found), Some(expected)) if expected.is_finite() => format!(
                "One frame ahead the last model is wrong by {} (root mean square); by itself, runs with noise and the errors of positions, it \
                 should be wrong by {}.",
                error(found),
                error(expected)
            ),
            _ => String::new(),
        };
        Self {
            figures: vec![
                Self::chart(
                    report,
                    "Displacement since the start",
                    report.skill.named(),
                    &report.best_possible,
                ),
                Self::chart(report, "Velocity over the last interval", report.velocity_skill.named(), &[]),
            ],
            columns: report.horizons.iter().map(ToString::to_string).collect(),
            rows,
            remark,
        }
    }

    fn chart<'a>(
        report: &ForecastReport,
        title: &str,
        of: impl Iterator<Item = (&'static str, &'a [Gain])>,
        best: &[f64],
    ) -> Figure {
        let mut series: Vec<PointSeries<'_>> = of
            .filter(|(name, _)| *name != "no motion")
            .map(|(label, own)| {
                let (colour, marker, aside) = match label {
                    "with effects" => (VERMILLION, Marker::Circle, 0.0),
                    "base model" => (BLUE, Marker::Square, 0.04),
                    "regression" => (GREEN, Marker::Diamond, -0.04),
                    _ => (GREY, Marker::Triangle, 0.08),
                };
                let point = |(horizon, own): (&usize, &Gain)| ErrorPoint {
                    at: [*horizon as f64 + aside, own.value],
                    error: [None, Some(own.standard_error).filter(|error| error.is_finite())],
                };
                let all = report.horizons.iter().zip(own);
                PointSeries {
                    label,
                    colour,
                    marker,
                    points: all.filter(|(_, own)| own.value > LEAST).map(point).collect(),
                }
            })
            .collect();
        series.push(PointSeries {
            label: "best possible",
            colour: INK,
            marker: Marker::Circle,
            points: report.horizons.iter().zip(best).map(|(h, own)| [*h as f64, *own].into()).collect(),
        });
        series.retain(|own| !own.points.is_empty());
        let x = format!(
            "frames ahead (one is {} {})",
            significant(report.interval.value, 3),
            unit_text(&report.interval.unit)
        );
        let svg = points_and_curves(&PointsAndCurves {
            title,
            labels: [&x, "skill"],
            scales: [AxisScale::Linear; 2],
            series: &series,
            curves: &[],
        });
        Figure::new(
            svg,
            &format!(
                "{title}: 1 is perfect, 0 as good as saying that nothing moves. Bars are one standard error."
            ),
        )
    }
}
