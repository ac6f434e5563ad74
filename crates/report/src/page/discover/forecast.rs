//! How well models say what the cells do next.

use super::super::words::with_error;
use super::super::{Block, Figure, Row, Section, Table, Text};
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
pub(super) fn section(report: &ForecastReport) -> Section {
    let moved = chart(report, "Displacement since the start", report.skill.named(), &report.best_possible);
    let last = chart(report, "Velocity over the last interval", report.velocity_skill.named(), &[]);
    Section::new("What the cells do next, said before")
        .with(Block::paragraph(Text::prose(&report.words)))
        .with(Block::remark(
            "From each frame that no fit has seen, the models go on by themselves, and are scored against what the cells did then. Beside them: each cell keeps the velocity \
             that it had, and a regression on the velocities that it and its neighbours had.",
        ))
        .with(Block::group("beside", [moved, last]))
        .with(Block::table(skills(report)))
        .with_all(expected(report).map(Block::remark))
}

fn skills(report: &ForecastReport) -> Table {
    let row =
        |name: &str, numbers: Vec<String>| -> Row { [name.to_owned()].into_iter().chain(numbers).collect() };
    let skills = |own: &[Gain]| own.iter().map(|own| with_error(own.value, own.standard_error)).collect();
    let best = report.best_possible.iter().map(|own| significant(*own, 3)).collect();
    let horizons = report.horizons.iter().map(ToString::to_string);
    Table::new(["skill, frames ahead".to_owned()].into_iter().chain(horizons))
        .class("")
        .rows(report.skill.named().map(|(name, own)| row(name, skills(own))))
        .rows(report.gain.iter().map(|gain| row("gain by the effects", skills(gain))))
        .row(row("best possible", best))
}

/// How wrong the last model is, and by itself should be.
fn expected(report: &ForecastReport) -> Option<Text> {
    let error = |own: &f64| format!("{} {}", significant(*own, 3), unit_text(&report.unit));
    let found = report.error.extended.as_ref().unwrap_or(&report.error.base).first()?;
    let expected = report.expected_error.extended.as_ref().unwrap_or(&report.expected_error.base).first()?;
    let text = format!(
        "One frame ahead the last model is wrong by {} (root mean square); by itself, runs with noise and the errors of positions, it \
         should be wrong by {}.",
        error(found),
        error(expected)
    );
    expected.is_finite().then(|| Text::plain(&text))
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
