//! The result of `discover` as a summary on stdout.

use super::phrases::probability;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_report::DiscoverReport;
use voronudge_report::discover_report::{Gain, HeldOutError, ModelFit};
use voronudge_report::numbers::{interval_text, significant};
use voronudge_report::units::unit_text;

/// Candidates shown; the report has all.
const SHOWN: usize = 5;

/// What the terminal shows.
pub(super) fn summary(report: &DiscoverReport, folder: &Path) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}: {}\n", report.verdict.name(), report.sentence);
    let forecast = report.forecast.as_ref().map_or("", |forecast| forecast.words.as_str());
    let check = report.check.as_ref().map_or("", |check| check.words.as_str());
    for sentence in [forecast, check, &report.caveat, &report.measure_next] {
        if !sentence.is_empty() {
            let _ = writeln!(text, "{sentence}\n");
        }
    }
    text.push_str(&errors(report));
    text.push_str(&forecasts(report));
    text.push_str(&predictions(report));
    text.push_str(&selected(report));
    text.push_str(&ranking(report));
    let _ = writeln!(text, "\nfigures in {}", folder.join("report.html").display());
    text
}

fn with_error(error: HeldOutError) -> String {
    format!("{} ± {}", significant(error.value, 3), significant(error.standard_error, 1))
}

fn errors(report: &DiscoverReport) -> String {
    let mut text = String::new();
    let held_out = |error: Option<HeldOutError>| error.map_or_else(|| "–".into(), with_error);
    let _ = writeln!(
        text,
        "{:<13} {:>16}  {:>11}  {:>12}  {:>12}",
        "error (NMSE)", "held out", "noise alone", "un-nudged", "chi²/dof"
    );
    let mut row = |name: &str, fit: &ModelFit| {
        let _ = writeln!(
            text,
            "{name:<13} {:>16}  {:>11}  {:>12}  {:>12}",
            held_out(fit.nmse.held_out()),
            significant(fit.noise_floor_nmse, 3),
            significant(fit.nmse.un_nudged, 3),
            significant(fit.chi_square_per_dof, 3)
        );
    };
    row("base", &report.models.before);
    if report.is_extended() {
        row("with effects", &report.models.after);
    }
    text
}

fn forecasts(report: &DiscoverReport) -> String {
    let Some(forecast) = &report.forecast else { return String::new() };
    let mut text = String::new();
    let mut row = |name: &str, cells: &[String]| {
        let cells: Vec<String> = cells.iter().take(SHOWN).map(|cell| format!("{cell:>18}")).collect();
        let _ = writeln!(text, "{name:<20}{}", cells.concat());
    };
    let ahead: Vec<String> = forecast.horizons.iter().map(|h| format!("{h} ahead")).collect();
    row("\nforecast skill", &ahead);
    for (name, skills) in forecast.skill.named() {
        let cell = |own: &Gain| match own.value.is_finite() {
            true => format!("{} ± {}", significant(own.value, 3), significant(own.standard_error, 1)),
            false => "–".into(),
        };
        row(name, &skills.iter().map(cell).collect::<Vec<_>>());
    }
    text
}

fn predictions(report: &DiscoverReport) -> String {
    let mut text = String::new();
    for own in &report.predictions {
        let (before, after) = (with_error(own.before), with_error(own.after));
        let _ =
            writeln!(text, "{} predicted, nothing fitted: base {before}, with effects {after}", own.dataset);
    }
    text
}

fn selected(report: &DiscoverReport) -> String {
    let mut text = String::new();
    for effect in &report.selected {
        let _ = writeln!(
            text,
            "\n{}: adjusted p {}, {} % of what is missing",
            effect.effect,
            probability(effect.p_adjusted),
            significant(100.0 * effect.share_of_excess, 2)
        );
        for (name, parameter) in effect.parameters() {
            let [value, interval] = match parameter.interval() {
                Some(ends) => interval_text(parameter.value, ends),
                None => [significant(parameter.value, 4), "–".into()],
            };
            let _ = writeln!(
                text,
                "  {}",
                format!("{name:<28} {value:>12}  {interval:<26} {}", unit_text(&parameter.unit)).trim_end()
            );
        }
    }
    text
}

fn ranking(report: &DiscoverReport) -> String {
    let mut text = String::new();
    if report.ranking.is_empty() {
        return text;
    }
    let _ =
        writeln!(text, "\n{:<24} {:>7} {:>10} {:>10}  why", "candidate", "size %", "limit %", "adjusted p");
    for effect in report.ranking.iter().take(SHOWN) {
        let _ = writeln!(
            text,
            "{:<24} {:>7} {:>10} {:>10}  {}",
            effect.effect,
            significant(effect.size, 2),
            significant(effect.detection_limit, 2),
            probability(effect.p_adjusted),
            effect.reason
        );
    }
    let more = report.ranking.len().saturating_sub(SHOWN);
    if more > 0 {
        let _ = writeln!(text, "and {more} more in the report");
    }
    text
}
