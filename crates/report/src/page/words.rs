//! Words and numbers that several pages say alike.

use super::{Block, Section};
use crate::infer_report::{CellCounts, FitStatus, FlowGrid, MeanRemoved, NoiseSource};
use crate::numbers::{NO_VALUE, significant, with_interval};

/// The caption of a map of polarities.
pub(super) const POLARITIES: &str = "polarities: what the cells move by of themselves";

/// What velocities belong to.
pub(super) fn data(flow: Option<&FlowGrid>) -> &'static str {
    if flow.is_some() { "grid points" } else { "cells" }
}

pub(super) fn mean_removed(mean: MeanRemoved) -> &'static str {
    match mean {
        MeanRemoved::None => "no mean velocity was removed",
        MeanRemoved::PerFrame => "the median velocity of each frame was removed",
        MeanRemoved::Overall => "the median velocity over all frames was removed",
    }
}

pub(super) fn noise_source(source: NoiseSource) -> &'static str {
    match source {
        NoiseSource::Given => "given on the command line",
        NoiseSource::DataSet => "stated by the data set",
        NoiseSource::Estimated => "estimated from these data",
        NoiseSource::Assumed => "assumed",
    }
}

pub(super) fn fit_status(status: FitStatus) -> &'static str {
    match status {
        FitStatus::Converged => "converged",
        FitStatus::IterationLimit => "stopped at the limit of iterations",
        FitStatus::Stalled => "stalled before a minimum",
    }
}

/// The section about what took no part in the fit; `data` is what velocities belong to.
pub(super) fn left_out(cells: &CellCounts, data: &str) -> Section {
    let reasons = cells.left_out.iter().map(|(reason, count)| [reason.replace('_', " "), count.to_string()]);
    Section::new("What was left out").with(match cells.left_out.is_empty() {
        true => Block::paragraph(format!("Nothing: all {} {data} were used.", cells.used)),
        false => Block::facts([[format!("{data} used"), cells.used.to_string()]].into_iter().chain(reasons)),
    })
}

/// A sentence with the symbols of the page.
pub(super) fn printed(words: &str) -> String {
    words.replace("alpha", "α")
}

/// The name of an effect as it is printed.
pub(super) fn effect_name(effect: &str) -> String {
    effect.replace('_', " ")
}

/// Names of effects as a list in a sentence, with `and` or another word before the last.
pub(super) fn listed<'a>(effects: impl IntoIterator<Item = &'a String>, joint: &str) -> String {
    let names: Vec<String> = effects.into_iter().map(|effect| effect_name(effect)).collect();
    match names.as_slice() {
        [others @ .., last] if !others.is_empty() => format!("{} {joint} {last}", others.join(", ")),
        _ => names.concat(),
    }
}

/// A number with its standard error, to the digits that this deserves.
pub(super) fn with_error(value: f64, error: f64) -> String {
    if !value.is_finite() || !error.is_finite() {
        return significant(value, 3);
    }
    let [value, ..] = with_interval(value, [value - error, value + error]);
    format!("{value} ± {}", significant(error, 2))
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", significant(100.0 * share, 2)) } else { NO_VALUE.to_owned() }
}

/// A probability; the very small ones are not told apart.
pub(super) fn probability(p: f64) -> String {
    if (0.0..1e-4).contains(&p) { "<\u{a0}0.0001".to_owned() } else { significant(p, 2) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_decide_the_digits() {
        assert_eq!(with_error(0.31234, 0.0213), "0.312 ± 0.021");
        assert_eq!(with_error(0.31234, f64::NAN), "0.312");
        assert_eq!(probability(0.0), "<\u{a0}0.0001");
        assert_eq!(percent(0.471), "47 %");
    }

    #[test]
    fn lists_end_with_and() {
        let names = ["drift", "shear", "odd_diffusion"].map(String::from);
        assert_eq!(listed(&names, "and"), "drift, shear and odd diffusion");
        assert_eq!(listed(&names[1..], "or"), "shear or odd diffusion");
        assert_eq!(listed(&names[..1], "and"), "drift");
        assert_eq!(listed(&[], "and"), "");
    }
}
