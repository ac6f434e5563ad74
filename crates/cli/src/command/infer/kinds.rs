//! Kinds of cells, told by labels: what is asked, and what a fit says of them.

use crate::command::fit::outcome;
use crate::command::fit::units::symbol;
use crate::failure::Failure;
use crate::problem::Problem;
use std::collections::BTreeMap;
use voronudge_infer::{Estimate, FitParameter, Inference, KindEstimates, Kinds, Method};
use voronudge_io::DataSet;
use voronudge_model::effect::LabelledParameter;
use voronudge_report::Units;
use voronudge_report::infer_report::{KindDifference, KindReport};
use voronudge_report::numbers::significant;

/// Kinds that nobody tells apart.
const MOST: usize = 12;
/// Cells of a label, in all frames together, below which they say nothing.
const FEWEST: usize = 5;
/// Probability below which it is said that kinds differ.
const LEVEL: f64 = 0.05;

/// What may be asked for, by name.
const KNOWN: [(&str, LabelledParameter); 3] = [
    ("K_P", LabelledParameter::Contractility),
    ("P_0", LabelledParameter::Adhesion),
    ("alpha", LabelledParameter::Chirality),
];

/// A parameter by its name.
pub(super) fn parameter(name: &str) -> Result<LabelledParameter, String> {
    let found = KNOWN.iter().find(|(known, _)| *known == name).map(|(_, parameter)| *parameter);
    found.ok_or_else(|| "labels may differ in K_P, P_0 and alpha".into())
}

fn refused(problem: impl Into<String>, hint: &str) -> Failure {
    Failure::new(problem).with_hint(hint)
}

/// The kinds asked for, whose reference is the most frequent label; refuses what does not go with them.
pub(super) fn check(
    asked: &[LabelledParameter],
    prepared: &Problem,
    data: &DataSet,
    varied: bool,
) -> Result<Option<Kinds>, Failure> {
    if asked.is_empty() {
        return Ok(None);
    }
    let has = |parameter| asked.contains(&parameter);
    let whole = has(LabelledParameter::Adhesion) && has(LabelledParameter::Chirality);
    let problem = match (data.labels.is_some(), (1..asked.len()).any(|k| asked[..k].contains(&asked[k]))) {
        (false, _) => {
            return Err(refused(
                "--by-label: the cells have no labels",
                "give data with labels.npy, or --labels FILE",
            ));
        }
        (_, true) => "--by-label has a parameter twice",
        _ if has(LabelledParameter::Contractility) && !whole => {
            return Err(refused(
                "--by-label: of cells with another K_P, P_0 and alpha are others, too",
                "write --by-label K_P,P_0,alpha",
            ));
        }
        _ if prepared.velocities.flow().is_some() => {
            "--by-label is for velocities of cells and tracks, not for a flow field"
        }
        _ if varied => "--by-label does not go with --vary",
        _ if matches!(prepared.request.method, Method::Descent { .. }) => {
            "--by-label does not go with --method descent"
        }
        _ => return of_labels(asked, &counts(prepared, data)).map(Some),
    };
    Err(refused(problem, "leave one of the two out"))
}

/// Number of cells of each label in the frames together.
fn counts(prepared: &Problem, data: &DataSet) -> BTreeMap<i64, usize> {
    let mut counts = BTreeMap::new();
    for (snapshot, &frame) in prepared.snapshots.iter().zip(&prepared.frames) {
        for label in data.labels_of(snapshot, frame).into_iter().flatten().flatten() {
            *counts.entry(label).or_default() += 1;
        }
    }
    counts
}

fn of_labels(asked: &[LabelledParameter], counts: &BTreeMap<i64, usize>) -> Result<Kinds, Failure> {
    if let Some((label, count)) = counts.iter().find(|(_, count)| **count < FEWEST) {
        let problem =
            format!("--by-label: of label {label} there are only {count} cells in all frames together");
        return Err(refused(problem, "write −1 for their label, or fit more frames"));
    }
    if !(2..=MOST).contains(&counts.len()) {
        let problem =
            format!("--by-label: the cells have {} labels, but 2 to {MOST} are needed", counts.len());
        return Err(refused(problem, "give labels that tell a few kinds of cells apart"));
    }
    let most = counts.iter().rev().max_by_key(|(_, count)| **count).map(|(label, _)| *label);
    let others = counts.keys().copied().filter(|label| Some(*label) != most).collect();
    Ok(Kinds { reference: most.unwrap_or_default(), others, parameters: asked.to_vec() })
}

/// The kinds for the report.
pub(super) fn report(
    prepared: &Problem,
    result: &Inference,
    data: &DataSet,
    units: &Units,
) -> Vec<KindReport> {
    let counts = counts(prepared, data);
    let tests = result.kinds.len().saturating_sub(1) as f64;
    let reference = result.kinds.first().map(|own| own.label);
    let told = |own: &KindEstimates| {
        let p_adjusted = 1.0 - (1.0 - own.p).powf(tests.max(1.0));
        let differences: BTreeMap<String, KindDifference> = (own.differences.iter())
            .map(|(quantity, difference)| {
                let scaled = difference.in_unit(prepared.scale.factor(*quantity));
                (quantity.name().to_owned(), described(&scaled))
            })
            .collect();
        KindReport {
            label: own.label,
            cells: counts.get(&own.label).copied().unwrap_or(0),
            is_reference: Some(own.label) == reference,
            parameters: outcome::parameters(prepared, &own.parameters, units),
            words: in_words(own, reference, (p_adjusted, p_adjusted < LEVEL)),
            differences,
            p: own.p,
            p_adjusted,
            differs: p_adjusted < LEVEL,
        }
    };
    result.kinds.iter().map(told).collect()
}

fn described(difference: &Estimate) -> KindDifference {
    let ci95 = difference.interval.map(|end| end.unwrap_or(f64::NAN));
    KindDifference { value: difference.value, ci95 }
}

/// What is said of a kind beside the reference.
fn in_words(own: &KindEstimates, reference: Option<i64>, (p, differs): (f64, bool)) -> String {
    let Some(reference) = reference.filter(|reference| *reference != own.label) else {
        return format!("cells of label {}: the parameters of the model", own.label);
    };
    // Below rounding it says no more.
    let p = if p < 1e-15 { "p < 10⁻¹⁵".into() } else { format!("p = {}", significant(p, 2)) };
    if !differs {
        return format!(
            "cells of label {} are not seen to differ from those of label {reference} ({p})",
            own.label
        );
    }
    let clear = |(_, difference): &&(FitParameter, Estimate)| !difference.covers(0.0);
    let said: Vec<String> = (own.differences.iter().filter(clear))
        .filter(|(quantity, _)| *quantity != FitParameter::ChiralCoefficient)
        .map(|(quantity, difference)| {
            format!("{} {}", symbol(*quantity), if difference.value > 0.0 { "higher" } else { "lower" })
        })
        .collect();
    match said.as_slice() {
        [] => format!("cells of label {} differ from those of label {reference} ({p})", own.label),
        _ => format!(
            "cells of label {} differ from those of label {reference}: {} ({p})",
            own.label,
            said.join(", ")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_the_names_of_the_interface() {
        assert_eq!(parameter("P_0"), Ok(LabelledParameter::Adhesion));
        assert!(parameter("K_A").unwrap_err().contains("alpha"));
    }
}
