//! The answer at a glance: what is missing, how sure that is, what it does to forecasts.

use serde::Serialize;

use super::super::parameter_table::TableRow;
use super::super::words::{effect_name, listed, probability, with_error};
use super::effects::rows;
use crate::discover_report::{DiscoverReport, ForecastReport, Gain, HeldOutError, SelectedEffect};

/// Coefficients of an effect that are told one by one, at most.
const MOST: usize = 2;

/// A question and what the search says to it.
#[derive(Serialize)]
pub(super) struct Answer {
    question: &'static str,
    lines: Vec<String>,
}

/// The first things that a reader asks.
pub(super) fn answers(report: &DiscoverReport) -> Vec<Answer> {
    let mut all = vec![
        Answer { question: "What is missing", lines: missing(report) },
        Answer { question: "How sure that is", lines: sureness(report) },
    ];
    if let Some(forecast) = &report.forecast {
        all.push(Answer { question: "What it does to forecasts", lines: forecasts(forecast) });
    }
    if let Some(check) = &report.check {
        all.push(Answer { question: "What the models make", lines: vec![check.words.clone()] });
    }
    all
}

/// Each effect with its coefficients.
fn missing(report: &DiscoverReport) -> Vec<String> {
    if report.selected.is_empty() {
        return vec![format!("nothing that can be named ({})", report.verdict.name().replace('_', " "))];
    }
    let line = |effect: &SelectedEffect| {
        let named = effect.coefficients.iter().zip(rows(effect));
        let mut values: Vec<String> =
            named.map(|(own, row)| value(&own.name, &TableRow::new(&row))).collect();
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
fn value(name: &str, row: &TableRow) -> String {
    let equals = if name.is_empty() { String::new() } else { format!("{name} = ") };
    let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
    format!("{equals}{}{unit} (95 %: {})", row.value, row.interval)
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
