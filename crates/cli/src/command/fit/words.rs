//! What a fit and its uncertainty mean, in plain words.

use voronudge_infer::{
    Direction, Doubt, Estimate, FitParameter, Inference, Method, ParameterEstimates, Profile, Voids,
};
use voronudge_report::numbers::significant;

/// Relative standard error above which a parameter counts as not identified.
const IDENTIFIED: f64 = 0.5;

/// Share of a direction that is told; the rest is small.
const TOLD: f64 = 0.8;

/// Fall of −2 log likelihood from the estimate to elsewhere that is no accident.
const MISSED: f64 = 3.84;

/// Coefficients in the order of a direction's components.
const COEFFICIENTS: [&str; 4] = ["K_A", "K_P P_0", "K_P", "K_P alpha"];

/// Index of K_P among the coefficients.
const DENOMINATOR: usize = 2;

/// A quantity as it is spoken of.
pub(crate) fn spoken(quantity: FitParameter) -> &'static str {
    match quantity {
        FitParameter::ChiralCoefficient => "K_P alpha",
        other => other.name(),
    }
}

/// A reason not to trust a fit, and what to do.
fn doubt(doubt: Doubt, result: &Inference, method: Method) -> String {
    let remedy = match method {
        Method::Search { .. } => "--starts 8",
        Method::Descent { .. } => "--method search",
    };
    match doubt {
        Doubt::Objective(deviations) => format!(
            "the objective is {} times its expected value ({} standard deviations above it): the fit is in a wrong minimum, \
             the noise levels are too small, or the model lacks something; try {remedy}, and check the noise levels \
             (intervals are widened accordingly)",
            significant(result.excess(), 3),
            significant(deviations, 2)
        ),
        Doubt::PositionNoise => {
            "the estimate of the position noise is as large as it may be: nudges could explain almost anything; give \
             --position-noise from an independent measurement"
                .into()
        }
        Doubt::Steps => "the fit ran out of steps before it reached a minimum; raise --max-steps".into(),
        Doubt::Voids(Voids { found, expected }) => format!(
            "cells were missed: {found} gaps are as large as an undetected cell leaves, where chance makes {}; forces on their \
             neighbours are wrong; look at the images there",
            significant(expected, 1)
        ),
        Doubt::Tails(ratio) => format!(
            "a few velocities are outliers (residuals scatter {} times as much as the smaller half of them \
             implies): missed, merged or split cells, or tracks that jump; look at the largest residuals",
            significant(ratio, 2)
        ),
        Doubt::Pattern => {
            "the residuals are correlated in space: the model or the description of the measurement lacks something; run discover"
                .into()
        }
        Doubt::LongSteps(step) => format!(
            "cells move by {} of their size between frames, and differences average that out: parameters are too small; give \
             frames that are closer in time",
            significant(step, 2)
        ),
        Doubt::Turning(ratio) => format!(
            "cells turn around between frames: along the fitted paths they move {} times as fast as their net displacement per frame, \
             so the fit may have found wrong paths; give frames that are closer in time",
            significant(ratio, 2)
        ),
        Doubt::Effect("time_lag", _) => {
            "velocities lag behind the positions, as differences over long intervals do; give frames that are closer in time"
                .into()
        }
        Doubt::Effect("flow_blur", _) => {
            "the flow is averaged over a window other than the one assumed; give --window and --window-width".into()
        }
        Doubt::Effect(_, share) => format!(
            "positions look like centroids of cells rather than the sites of their polygons ({} of the way)",
            significant(share, 2)
        ),
        Doubt::Integration(errors) => format!(
            "the cells move so far between frames that a finer integration would change a coefficient by {} standard errors; \
             fit fewer frames at a time, or frames that are closer in time",
            significant(errors, 2)
        ),
    }
}

/// The name of what is in doubt where a profile is lower elsewhere than at the estimate.
const PROFILE: &str = "profile";

/// Every reason not to trust a fit, with the name of what is in doubt: its own, and profiles that are lower elsewhere.
pub(crate) fn doubts(
    result: &Inference,
    profiles: &[Profile],
    method: Method,
) -> Vec<(&'static str, String)> {
    let missed = profiles.iter().filter_map(|profile| {
        let estimate = result.parameters.get(profile.quantity).value;
        let (_, rise) = profile.points.iter().find(|(value, _)| *value == estimate)?;
        (*rise > MISSED).then(|| {
            let text = format!(
                "the profile of {} is lower elsewhere than at the estimate, by {}: the fit missed a minimum; try --starts 8",
                spoken(profile.quantity),
                significant(*rise, 2)
            );
            (PROFILE, text)
        })
    });
    result.doubts.iter().map(|own| (own.part().name(), doubt(*own, result, method))).chain(missed).collect()
}

/// How well a quantity is known.
pub(crate) fn parameter(quantity: FitParameter, estimate: &Estimate) -> String {
    let name = spoken(quantity);
    let Estimate { value, standard_error, interval } = estimate;
    if *standard_error == 0.0 {
        return format!("{name} is held");
    }
    let side = match interval {
        [Some(low), Some(high)] if low == value && high > value => Some("lower"),
        [Some(low), Some(high)] if high == value && low < value => Some("upper"),
        [Some(low), None] if low == value => Some("lower"),
        [None, Some(high)] if high == value => Some("upper"),
        _ => None,
    };
    if let Some(side) = side {
        return format!("{name} is at its {side} bound");
    }
    match interval {
        _ if is_identified(estimate) => {
            format!("{name} is known to {}", percent(standard_error / value.abs()))
        }
        [Some(low), Some(high)] if *low < 0.0 && *high > 0.0 => {
            format!("{name} is not identified by these data: its sign is not determined")
        }
        _ => format!("{name} is not identified by these data"),
    }
}

/// Whether an interval is bounded and away from zero, and the standard error a moderate share of the value.
fn is_identified(estimate: &Estimate) -> bool {
    let Estimate { value, standard_error, interval } = estimate;
    let [Some(low), Some(high)] = interval else { return false };
    low * high > 0.0 && standard_error / value.abs() <= IDENTIFIED
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, if share < 0.095 { 1 } else { 2 }))
}

/// Every direction in words, in their order.
pub(crate) fn directions(directions: &[Direction], estimates: &ParameterEstimates) -> Vec<String> {
    let count = directions.len();
    let rank = |index: usize| match index {
        0 if count == 1 => "the only free combination".to_owned(),
        0 => "the stiffest combination".into(),
        index if index + 1 == count => "the sloppiest combination".into(),
        1 => "the second stiffest combination".into(),
        _ => "the third stiffest combination".into(),
    };
    let text = |(index, direction): (usize, &Direction)| {
        format!("{} {}", rank(index), combination(&direction.components, estimates))
    };
    directions.iter().enumerate().map(text).collect()
}

/// The stiffest and the sloppiest direction in one sentence.
pub(crate) fn in_short(directions: &[String]) -> String {
    match directions {
        [] => String::new(),
        [only] => only.clone(),
        [first, .., last] => format!("{first}; {last}"),
    }
}

/// What a direction changes: `is K_A`, or `raises … and lowers …`.
fn combination(components: &[f64; 4], estimates: &ParameterEstimates) -> String {
    let mut order: Vec<usize> = (0..components.len()).collect();
    order.sort_by(|a, b| components[*b].abs().total_cmp(&components[*a].abs()));
    let mut told = 0.0;
    let mut chosen = order;
    chosen.retain(|&index| {
        let needed = told < TOLD;
        told += components[index].powi(2);
        needed
    });
    if let [only] = chosen[..] {
        return format!("is {}", COEFFICIENTS[only]);
    }
    let leading = components[chosen[0]].signum();
    let names = |rises: bool| -> Vec<&str> {
        let matching = chosen.iter().filter(|&&index| (components[index] * leading > 0.0) == rises);
        matching.map(|&index| COEFFICIENTS[index]).collect()
    };
    let (raised, lowered) = (names(true), names(false));
    let text = match lowered.is_empty() {
        true => format!("raises {} together", listed(&raised)),
        false => format!("raises {} and lowers {}", listed(&raised), listed(&lowered)),
    };
    text + &told_ratios(&chosen, components, estimates)
}

/// What a direction does to those ratios to K_P that are known: where both coefficients follow the sign of their ratio, it
/// stays much as it is, and otherwise it changes.
fn told_ratios(chosen: &[usize], components: &[f64; 4], estimates: &ParameterEstimates) -> String {
    let ratios = [(1, FitParameter::PreferredPerimeter), (3, FitParameter::Chirality)];
    let (mut kept, mut changed) = (Vec::new(), Vec::new());
    for (index, quantity) in ratios {
        let ratio = estimates.get(quantity);
        let both = chosen.contains(&index) && chosen.contains(&DENOMINATOR);
        if !both || !is_identified(ratio) {
            continue;
        }
        match components[index] * components[DENOMINATOR] * ratio.value > 0.0 {
            true => kept.push(parameter(quantity, ratio)),
            false => changed.push(spoken(quantity)),
        }
    }
    match (kept.as_slice(), changed.as_slice()) {
        ([], []) => String::new(),
        ([], changed) => format!(", which changes {}", listed(changed)),
        ([only], _) => format!(" (their ratio {only})"),
        (several, _) => format!(" (of their ratios, {})", several.join(" and ")),
    }
}

fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64, standard_error: f64) -> Estimate {
        let half = 1.96 * standard_error;
        Estimate { value, standard_error, interval: [Some(value - half), Some(value + half)] }
    }

    fn estimates() -> ParameterEstimates {
        ParameterEstimates {
            area_elasticity: estimate(0.1, 0.2),
            perimeter_elasticity: estimate(1.0, 0.2),
            preferred_perimeter: estimate(4.0, 0.12),
            chirality: estimate(-3.4, 0.7),
            chiral_coefficient: estimate(-3.4, 0.06),
        }
    }

    #[test]
    fn a_parameter_is_known_or_not_identified() {
        let say = |estimate: Estimate| parameter(FitParameter::ChiralCoefficient, &estimate);
        assert_eq!(say(estimate(-3.4, 0.06)), "K_P alpha is known to 2 %");
        assert_eq!(say(estimate(3.4, 0.68)), "K_P alpha is known to 20 %");
        assert_eq!(
            say(estimate(0.1, 0.2)),
            "K_P alpha is not identified by these data: its sign is not determined"
        );
        let skewed = Estimate { value: 1.0, standard_error: 0.6, interval: [Some(0.1), Some(3.0)] };
        assert_eq!(say(skewed), "K_P alpha is not identified by these data");
        let unbounded = Estimate { value: 1.0, standard_error: 0.1, interval: [Some(0.1), None] };
        assert_eq!(say(unbounded), "K_P alpha is not identified by these data");
        let bounded = Estimate { value: 0.0, standard_error: 0.1, interval: [Some(0.0), Some(0.2)] };
        assert_eq!(say(bounded), "K_P alpha is at its lower bound");
        let held = Estimate { value: 1.0, standard_error: 0.0, interval: [Some(1.0); 2] };
        assert_eq!(say(held), "K_P alpha is held");
    }

    #[test]
    fn directions_tell_what_they_change() {
        let direction = |components| Direction { eigenvalue: 1.0, components };
        let words = directions(
            &[
                direction([0.0, 0.05, -0.1, 0.99]),
                direction([0.1, -0.6, 0.78, 0.1]),
                direction([0.0, 0.97, 0.24, 0.0]),
                direction([0.05, 0.7, 0.7, 0.0]),
            ],
            &estimates(),
        );
        assert_eq!(words[0], "the stiffest combination is K_P alpha");
        assert_eq!(
            words[1],
            "the second stiffest combination raises K_P and lowers K_P P_0, which changes P_0"
        );
        assert_eq!(words[2], "the third stiffest combination is K_P P_0");
        let last =
            "the sloppiest combination raises K_P P_0 and K_P together (their ratio P_0 is known to 3 %)";
        assert_eq!(words[3], last);
        assert_eq!(in_short(&words), format!("{}; {last}", words[0]));
    }

    #[test]
    fn a_ratio_is_kept_where_both_follow_its_sign() {
        let say = |components| combination(&components, &estimates());
        assert_eq!(
            say([0.0, 0.0, 0.6, -0.8]),
            "raises K_P alpha and lowers K_P (their ratio alpha is known to 21 %)"
        );
        assert_eq!(say([0.0, 0.0, 0.6, 0.8]), "raises K_P alpha and K_P together, which changes alpha");
        let both = say([0.0, 0.7, 0.5, -0.5]);
        assert!(
            both.ends_with("(of their ratios, P_0 is known to 3 % and alpha is known to 21 %)"),
            "{both}"
        );
        let alone =
            directions(&[Direction { eigenvalue: 1.0, components: [1.0, 0.0, 0.0, 0.0] }], &estimates());
        assert_eq!(in_short(&alone), "the only free combination is K_A");
    }
}
