//! Effects as the report tells them.

use super::phrases::{listed, percent, probability};
use super::sentences::told_apart_by;
use crate::command::fit::prospects::Coefficient;
use crate::problem::Problem;
use voronudge_infer::Estimate;
use voronudge_infer::discover::{Discovery, Fate, Ranked, Selected};
use voronudge_model::effect::{Effect, Kind, Unit};
use voronudge_report::Units;
use voronudge_report::discover_report::{
    CandidateStatus, EffectCoefficient, EffectKind, Gain, RankedEffect, SelectedEffect,
};

/// The unit of a rate.
const RATE: Unit = Unit { length: 0, time: -1 };

/// The family of an effect.
pub(super) fn family(effect: &Effect) -> EffectKind {
    match effect.id {
        "drift" | "expansion" | "rotation" | "shear" | "quadratic_distortion" => EffectKind::Motion,
        "p0_gradient"
        | "kp_gradient"
        | "alpha_gradient"
        | "friction_gradient"
        | "size_friction"
        | "alpha_area"
        | "p0_heterogeneity"
        | "a0_heterogeneity"
        | "alpha_heterogeneity"
        | "coordination_tension" => EffectKind::Gradient,
        "persistence" | "alignment" | "polarity" | "polarity_alignment" | "contact_inhibition"
        | "velocity_alignment" | "random_motion" => EffectKind::History,
        "label_parameter" | "external_field" => EffectKind::Measured,
        "boundary_tension" | "boundary_torque" => EffectKind::Boundary,
        _ => match effect.kind {
            Kind::Mechanism => EffectKind::Force,
            Kind::Observation => EffectKind::Observation,
            Kind::Description => EffectKind::Description,
        },
    }
}

/// Names of the coefficients, in the order of the columns; empty for the only one.
fn coefficient_names(selected: &Selected, prepared: &Problem) -> Vec<String> {
    let count = selected.columns.len().max(selected.coefficients.len());
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    match (selected.effect.id, count) {
        ("polarity_alignment", 1) => owned(&["J"]),
        ("contact_inhibition", 1) => owned(&["b"]),
        ("velocity_alignment", 1) => owned(&["kappa"]),
        ("random_motion", 1) => owned(&["D"]),
        ("p0_heterogeneity" | "a0_heterogeneity" | "alpha_heterogeneity", 1) => owned(&["s"]),
        (_, 1) => vec![String::new()],
        ("drift", 2) => owned(&["along x", "along y"]),
        ("polarity", 2) => owned(&["v_0", "D_r"]),
        ("shear", 2) => owned(&["along the axes", "along the diagonals"]),
        ("quadratic_distortion", 6) => {
            owned(&["x^2 to x", "x^2 to y", "xy to x", "xy to y", "y^2 to x", "y^2 to y"])
        }
        ("p0_gradient" | "kp_gradient" | "alpha_gradient" | "friction_gradient", 2) => {
            owned(&["along x", "along y"])
        }
        ("p0_gradient" | "kp_gradient" | "alpha_gradient" | "friction_gradient", 4) => {
            owned(&["sine along x", "cosine along x", "sine along y", "cosine along y"])
        }
        ("label_parameter", _) => {
            let of_frames = prepared.observations.iter().map(|frame| frame.environment().other_labels());
            let of_tracks = prepared.tracks.iter().map(|tracks| tracks.movie.other_labels());
            let labels = of_tracks.chain(of_frames).max_by_key(Vec::len).unwrap_or_default();
            let parameters = ["adhesion", "contractility", "chirality"];
            let names =
                labels.iter().flat_map(|label| parameters.map(|what| format!("{what} of label {label}")));
            names.chain((1..).map(|number| number.to_string())).take(count).collect()
        }
        _ => (1..=count).map(|number| number.to_string()).collect(),
    }
}

/// The coefficients of the effects that were added, with their standard errors, in the units of the data.
pub(super) fn coefficients(discovery: &Discovery, prepared: &Problem, units: &Units) -> Vec<Coefficient> {
    let of = |selected: &Selected| -> Vec<Coefficient> {
        let names = coefficient_names(selected, prepared);
        let of_one = |(name, estimate): (&String, &Estimate)| {
            let unit = if name == "D_r" { RATE } else { selected.effect.unit };
            let factor = prepared.scale.unit(unit);
            Coefficient {
                effect: selected.effect.id,
                name: format!("{} {name}", selected.effect.id).trim_end().to_owned(),
                value: estimate.value * factor,
                standard_error: estimate.standard_error * factor,
                unit: units.powers(unit.length.into(), unit.time.into()),
            }
        };
        names.iter().zip(&selected.coefficients).map(of_one).collect()
    };
    discovery.selected.iter().flat_map(of).collect()
}

/// An effect that was added.
pub(super) fn selected(selected: &Selected, prepared: &Problem, units: &Units) -> SelectedEffect {
    let effect = selected.effect;
    let names = coefficient_names(selected, prepared);
    let unit_of = |name: &String| if name == "D_r" { RATE } else { effect.unit };
    let ends = |(name, estimate): (&String, &Estimate)| {
        let factor = prepared.scale.unit(unit_of(name));
        let [low, high] = estimate.interval;
        [low.unwrap_or(f64::NEG_INFINITY) * factor, high.unwrap_or(f64::INFINITY) * factor]
    };
    let others = || selected.class.iter().filter(|other| other.id != effect.id);
    SelectedEffect {
        effect: effect.id.into(),
        formula: effect.formula.into(),
        meaning: effect.meaning.into(),
        kind: family(effect),
        coefficients: (names.iter().zip(&selected.coefficients))
            .map(|(name, estimate)| EffectCoefficient {
                name: name.clone(),
                value: estimate.value * prepared.scale.unit(unit_of(name)),
                unit: units.powers(unit_of(name).length.into(), unit_of(name).time.into()),
            })
            .collect(),
        ci95: names.iter().zip(&selected.coefficients).map(ends).collect(),
        p_adjusted: selected.adjusted_p,
        share_of_excess: selected.share_of_excess,
        class: others().map(|other| other.id.to_owned()).collect(),
        told_apart_by: others().map(|other| (other.id.to_owned(), told_apart_by(effect, other))).collect(),
    }
}

/// What became of a candidate.
pub(super) fn ranked(candidate: &Ranked, discovery: &Discovery) -> RankedEffect {
    let percentage = |share: f64| 100.0 * share;
    let only = matches!(discovery.selected.as_slice(), [only] if only.effect.id == candidate.effect.id);
    let gain = discovery.gain.filter(|_| only);
    let (status, reason) = verdict(candidate, discovery);
    // What could not be tested has no statistic.
    let tested = |number: f64| if candidate.dimension == 0 { f64::NAN } else { number };
    RankedEffect {
        effect: candidate.effect.id.into(),
        kind: family(candidate.effect),
        dimension: candidate.dimension,
        statistic: tested(candidate.statistic),
        p: tested(candidate.p),
        p_adjusted: tested(candidate.adjusted_p),
        detection_limit: percentage(candidate.detection_limit),
        size: percentage(candidate.size),
        size_ci95: candidate.interval.map(|ends| ends.map(percentage)),
        gain: gain.map(Gain::from),
        status,
        reason,
    }
}

/// Why a candidate was taken or not.
fn verdict(candidate: &Ranked, discovery: &Discovery) -> (CandidateStatus, String) {
    let p = probability(candidate.adjusted_p);
    match &candidate.fate {
        Fate::Selected => {
            let found = discovery.selected.iter().find(|selected| selected.effect.id == candidate.effect.id);
            // What nothing predicts explains nothing.
            let found = found.filter(|own| !own.effect.is_random_motion());
            let share = found.map_or(String::new(), |selected| {
                format!(", explains {} of what is missing without it", percent(selected.share_of_excess))
            });
            (CandidateStatus::Selected, format!("stands out against chance{share}"))
        }
        Fate::Alias(id) => (CandidateStatus::Alias, format!("these data cannot tell it from {id}")),
        Fate::Absorbed => (
            CandidateStatus::NotTestable,
            "a change of the parameters of the base model does the same".into(),
        ),
        Fate::BelowThreshold => {
            (CandidateStatus::BelowThreshold, format!("no more than chance (adjusted p {p})"))
        }
        Fate::Explained => {
            let added: Vec<&str> = discovery.selected.iter().map(|selected| selected.effect.id).collect();
            (
                CandidateStatus::BelowThreshold,
                format!("explains nothing more beside {}", listed(&added, "and")),
            )
        }
        Fate::NotConfirmed(why) => {
            (CandidateStatus::BelowThreshold, format!("better than chance (adjusted p {p}), but {why}"))
        }
        Fate::NotFitted(error) => (
            CandidateStatus::BelowThreshold,
            format!("better than chance (adjusted p {p}), but the fit with it fails: {error}"),
        ),
        Fate::NotTestable(why) => (CandidateStatus::NotTestable, (*why).to_owned()),
        Fate::Description => {
            (CandidateStatus::Description, "a description, which is never named as a cause".into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_belongs_to_a_family() {
        let of = |id: &str| Effect::from_id(id).map(family);
        assert_eq!(of("drift"), Some(EffectKind::Motion));
        assert_eq!(of("nematic_stress"), Some(EffectKind::Force));
        assert_eq!(of("flow_gain"), Some(EffectKind::Observation));
        assert_eq!(of("smooth_field"), Some(EffectKind::Description));
        for effect in Effect::all() {
            let is_description = family(effect) == EffectKind::Description;
            assert_eq!(is_description, effect.kind == Kind::Description, "{}", effect.id);
        }
    }
}
