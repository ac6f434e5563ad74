//! What to measure next, computed: what a fit would know with other measurements.

use super::units::{symbol, unit};
use crate::problem::Problem;
use std::collections::BTreeMap;
use voronudge_infer::{Ambiguity, FitParameter, Inference, Prospects};
use voronudge_report::Units;
use voronudge_report::infer_report::{AmbiguityReport, DESIGNS, ProspectOf, ProspectsReport};
use voronudge_report::numbers::significant;

/// A standard error above this share of the value hardly tells its sign.
const SIGN: f64 = 0.5;

/// A coefficient of an effect, in the units of the data.
pub(crate) struct Coefficient {
    /// The effect.
    pub effect: &'static str,
    pub name: String,
    pub value: f64,
    pub standard_error: f64,
    pub unit: String,
}

/// Something that is uncertain: how much, in the words of now and with each measurement.
struct Uncertain {
    name: String,
    /// How it is spoken of.
    spoken: String,
    /// Standard error relative to the size, and to what if not to the value.
    relative: f64,
    beside: &'static str,
    /// Standard errors as shares of the present one, by name of the measurement.
    shares: BTreeMap<String, f64>,
}

/// What would be known of the parameters and of effects, whose coefficients come in the order of the prospects.
pub(crate) fn report(
    prepared: &Problem,
    result: &Inference,
    prospects: &Prospects,
    effects: &[Coefficient],
    units: &Units,
) -> ProspectsReport {
    let scale = &prepared.scale;
    let shares = |of: &dyn Fn(&voronudge_infer::Prospect) -> f64| -> BTreeMap<String, f64> {
        let designs = prospects.designs.iter().map(|own| (own.design.name().to_owned(), of(own)));
        designs.filter(|(_, share)| share.is_finite()).collect()
    };
    let size = result.parameters.perimeter_elasticity.value.abs();
    let (mut quantities, mut uncertain) = (Vec::new(), Vec::new());
    for (k, quantity) in FitParameter::ALL.into_iter().enumerate() {
        let estimate = result.parameters.get(quantity);
        let shares = shares(&|own| own.parameters[k]);
        if estimate.standard_error == 0.0 || shares.is_empty() {
            continue;
        }
        let in_units = scale.factor(quantity);
        let (name, unit) = (quantity.name().to_owned(), unit(quantity, units));
        // Ratios follow from the others; what is small beside K_P does little, however large its error beside itself.
        let own = estimate.value.abs();
        let (usual, beside) = match quantity {
            FitParameter::AreaElasticity | FitParameter::ChiralCoefficient if size > own => (size, " of K_P"),
            _ => (own, ""),
        };
        if quantity != FitParameter::Chirality {
            let relative = estimate.standard_error / usual;
            uncertain.push(Uncertain {
                name: name.clone(),
                spoken: symbol(quantity).into(),
                relative,
                beside,
                shares: shares.clone(),
            });
        }
        let (value, error) = (estimate.value * in_units, estimate.standard_error * in_units);
        quantities.push(prospect((name, unit), (value, error), &shares));
    }
    let mut of_effects: Vec<(&str, Uncertain)> = Vec::new();
    for (k, own) in effects.iter().enumerate() {
        let shares = shares(&|prospect| prospect.effects.get(k).copied().unwrap_or(f64::NAN));
        if shares.is_empty() {
            continue;
        }
        let (name, relative) = (own.name.clone(), own.standard_error / own.value.abs());
        let uncertain = Uncertain {
            name: name.clone(),
            spoken: name.clone(),
            relative,
            beside: "",
            shares: shares.clone(),
        };
        // An effect is as certain as its most certain coefficient.
        match of_effects.last_mut() {
            Some((effect, last)) if *effect == own.effect => {
                if relative < last.relative {
                    *last = uncertain;
                }
            }
            _ => of_effects.push((own.effect, uncertain)),
        }
        quantities.push(prospect((name, own.unit.clone()), (own.value, own.standard_error), &shares));
    }
    let open: Vec<Uncertain> = prospects.ambiguities.iter().map(of_ambiguity).collect();
    // What was found matters more than parameters, and what it is more than how large.
    let of_effects = of_effects.into_iter().map(|(_, own)| own).collect();
    let first = [open, of_effects, uncertain].into_iter().find(|all| !all.is_empty()).unwrap_or_default();
    let least = first
        .into_iter()
        .filter(|own| own.relative.is_finite())
        .max_by(|a, b| a.relative.total_cmp(&b.relative));
    let best = least.as_ref().and_then(best);
    ProspectsReport {
        words: least.as_ref().map_or_else(String::new, words),
        least_certain: least.map(|own| own.name),
        recommended: best.as_ref().map(|(name, _)| name.clone()),
        share: best.map(|(_, share)| share),
        quantities,
        ambiguities: prospects.ambiguities.iter().map(ambiguity).collect(),
    }
}

fn prospect(
    (name, unit): (String, String),
    (value, standard_error): (f64, f64),
    shares: &BTreeMap<String, f64>,
) -> ProspectOf {
    let expected = shares.iter().map(|(design, share)| (design.clone(), share * standard_error)).collect();
    ProspectOf { name, value, standard_error, unit, expected }
}

/// The measurement with the smallest standard error, the first of several alike.
fn best(own: &Uncertain) -> Option<(String, f64)> {
    let told = DESIGNS.iter().filter_map(|(name, _)| Some(((*name).to_owned(), *own.shares.get(*name)?)));
    // Rounding makes no difference.
    told.min_by(|a, b| if (a.1 - b.1).abs() < 1e-6 { std::cmp::Ordering::Equal } else { a.1.total_cmp(&b.1) })
}

/// The advice about what is least certain.
fn words(own: &Uncertain) -> String {
    let Some((best, share)) = best(own) else { return String::new() };
    let spoken =
        |name: &str| DESIGNS.iter().find(|(known, _)| *known == name).map_or("", |(_, words)| *words);
    let others: Vec<String> = DESIGNS
        .iter()
        .filter(|(name, _)| *name != best)
        .filter_map(|(name, words)| Some(format!("{words} {}", significant(*own.shares.get(*name)?, 2))))
        .collect();
    let percent = significant(100.0 * own.relative, 2);
    let known =
        format!("{} to {percent} %{}", if own.relative < SIGN { "known" } else { "known only" }, own.beside);
    let mut best = spoken(&best).to_owned();
    best[..1].make_ascii_uppercase();
    format!(
        "{best} would bring the standard error of {}, {known}, to {} of what it is{}.",
        own.spoken,
        significant(share, 2),
        if others.is_empty() { String::new() } else { format!(" ({})", others.join(", ")) }
    )
}

/// Two effects that cannot be told apart: the standard error is that of the first beside the other.
fn of_ambiguity(own: &Ambiguity) -> Uncertain {
    let shares =
        own.with.iter().map(|(design, separation)| (design.name().into(), own.separation / separation));
    Uncertain {
        name: ambiguity(own).name(),
        spoken: format!("{} beside {}", own.effect, own.other),
        relative: 1.0 / own.separation,
        beside: "",
        shares: shares.collect(),
    }
}

fn ambiguity(own: &Ambiguity) -> AmbiguityReport {
    AmbiguityReport {
        effect: own.effect.into(),
        other: own.other.into(),
        separation: own.separation,
        expected: own.with.iter().map(|(design, value)| (design.name().into(), *value)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uncertain(relative: f64, shares: &[(&str, f64)]) -> Uncertain {
        let shares = shares.iter().map(|(name, share)| ((*name).to_owned(), *share)).collect();
        Uncertain { name: "K_A".into(), spoken: "K_A".into(), relative, beside: " of K_P", shares }
    }

    #[test]
    fn the_advice_names_the_best_measurement_and_the_others() {
        let shares =
            [("twice_the_frames", 0.71), ("half_the_position_noise", 0.42), ("twice_the_field", 0.71)];
        let told = words(&uncertain(0.3, &shares));
        assert_eq!(
            told,
            "Half the error of positions would bring the standard error of K_A, known to 30 % of K_P, to 0.42 of what it is \
             (twice the frames 0.71, twice the field of view 0.71)."
        );
        let alike = [("twice_the_field", 0.5), ("twice_the_frames", 0.5)];
        assert!(words(&uncertain(0.9, &alike)).starts_with("Twice the frames would"));
        assert!(words(&uncertain(0.9, &[])).is_empty());
    }

    #[test]
    fn measurements_have_the_same_names_everywhere() {
        assert_eq!(DESIGNS.map(|(name, _)| name), voronudge_infer::Design::ALL.map(|design| design.name()));
    }
}
