//! The answer at a glance: what is missing, how sure that is, what it does to forecasts.

use super::super::parameter_table::value_and_interval;
use super::super::words::{effect_name, listed, probability, with_error};
use super::super::{Block, Text};
use super::effects::rows;
use crate::discover_report::{DiscoverReport, ForecastReport, Gain, HeldOutError, SelectedEffect};
use crate::figure::ParameterRow;
use crate::units::unit_text;

/// Coefficients of an effect that are told one by one, at most.
const MOST: usize = 2;

/// The first things that a reader asks, and what the search says to them.
pub(super) fn answers(report: &DiscoverReport) -> Block {
    let forecasts = report.forecast.as_ref().map(|own| ("What it does to forecasts", forecasts(own)));
    let check = report.check.as_ref().map(|own| ("What the models make", vec![own.words.clone()]));
    let all = [("What is missing", missing(report)), ("How sure that is", sureness(report))];
    let entry = |(question, lines): (&str, Vec<String>)| {
        [question.into(), Text::lines(lines.iter().map(|line| Text::prose(line)))]
    };
    let entries = all.into_iter().chain(forecasts).chain(check).map(entry).collect();
    Block::Terms { class: "answers", entries }
}

/// Each effect with its coefficients.
fn missing(report: &DiscoverReport) -> Vec<String> {
    if report.selected.is_empty() {
        return vec![format!("nothing that can be named ({})", report.verdict.name().replace('_', " "))];
    }
    let line = |effect: &SelectedEffect| {
        let named = effect.coefficients.iter().zip(rows(effect));
        let mut values: Vec<String> = named.map(|(own, row)| value(&own.name, &row)).collect();
        if values.len() > MOST {
            values = vec![format!("{} coefficients", values.len())];
        }
        let name = effect_name(&effect.effect);
        let others = match effect.class.is_empty() {
            true => String::new(),
            false => format!(", or {}", listed(&effect.class, "or")),
        };
        format!("{name}{others}: {}", values.join("; "))
    };
    report.selected.iter().map(line).collect()
}

/// A coefficient with its interval; that of an effect with one alone needs no name.
fn value(name: &str, row: &ParameterRow) -> String {
    let equals = if name.is_empty() { String::new() } else { format!("{name} = ") };
    let [value, interval] = value_and_interval(row);
    let value = format!("{value} {}", unit_text(&row.unit));
    format!("{equals}{} (95 %: {interval})", value.trim_end())
}

/// Errors on data that no fit has seen, and what chance does.
fn sureness(report: &DiscoverReport) -> Vec<String> {
    let mut lines = Vec::new();
    let error = |own: HeldOutError| with_error(own.value, own.standard_error);
    let [before, after] = [&report.models.before, &report.models.after].map(|own| own.nmse.held_out());
    match (before, after) {
        (Some(before), Some(after)) if report.is_extended() => {
            lines.push(format!(
                "error on data that no fit has seen: {} before, {} after",
                error(before),
                error(after)
            ));
        }
        (Some(before), _) => lines.push(format!("error on data that no fit has seen: {}", error(before))),
        _ => (),
    }
    let largest = report.selected.iter().map(|own| own.p_adjusted).fold(f64::NAN, f64::max);
    if largest.is_finite() {
        lines.push(format!(
            "chance alone makes the best of all candidates look as good with p {}",
            probability(largest)
        ));
    }
    lines
}

/// Skills at the first and the last horizon.
fn forecasts(report: &ForecastReport) -> Vec<String> {
    let line = |k: usize| {
        let skill = |own: &[Gain]| own.get(k).map(|own| with_error(own.value, own.standard_error));
        let frames = report.horizons.get(k)?;
        let own = skill(&report.skill.base)?;
        let unit = if *frames == 1 { "frame" } else { "frames" };
        let models = match report.skill.extended.as_deref().and_then(skill) {
            Some(extended) => format!("{own} before, {extended} after"),
            None => own,
        };
        Some(format!("{frames} {unit} ahead {models}"))
    };
    let last = report.horizons.len().saturating_sub(1);
    let skills: Vec<String> =
        [Some(0), (last > 0).then_some(last)].into_iter().flatten().filter_map(line).collect();
    vec![format!("skill (1 is perfect, 0 as good as no motion): {}", skills.join("; ")), report.words.clone()]
}
