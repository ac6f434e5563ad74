//! What is said of the parameters before a fit.

use crate::failure::Failure;
use clap::Args;
use std::collections::BTreeMap;
use voronudge_infer::{CoefficientSpace, Constraints, FitParameter, Prior};

#[derive(Debug, Args)]
#[command(next_help_heading = "Fit")]
pub(crate) struct ConstraintArguments {
    /// Hold a parameter at a value, in the units of the data: `--fix K_A=0.1`. NAME is K_A, K_P, P_0, alpha or
    /// K_P_alpha. May be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = fixed, allow_hyphen_values = true)]
    fix: Vec<(FitParameter, f64)>,
    /// Keep a parameter between two values, either of which may be left out: `--bounds K_A=0..0.5`, `K_A=0..`,
    /// `P_0=..4.2`. NAME as for --fix. May be repeated.
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = bounds, allow_hyphen_values = true)]
    bounds: Vec<(FitParameter, [f64; 2])>,
    /// Use prior knowledge of a parameter, a Gaussian with this mean and standard deviation: `--prior P_0=3.9±0.2` or
    /// `P_0=3.9,0.2`. NAME as for --fix. May be repeated.
    #[arg(long, value_name = "NAME=MEAN±SD", value_parser = prior, allow_hyphen_values = true)]
    prior: Vec<(FitParameter, Prior)>,
    /// Do not allow negative stiffnesses: short for `--bounds K_A=0.. --bounds K_P=0..`.
    #[arg(long)]
    stable: bool,
}

/// The quantity of a name.
pub(crate) fn quantity(name: &str) -> Result<FitParameter, String> {
    FitParameter::from_name(name)
        .ok_or_else(|| format!("{name} is not a parameter; there are K_A, K_P, P_0, alpha and K_P_alpha"))
}

fn named<'t>(text: &'t str, example: &str) -> Result<(FitParameter, &'t str), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("write {example}"))?;
    Ok((quantity(name)?, value.trim()))
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("{text} is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("{text} is not finite")) }
}

fn fixed(text: &str) -> Result<(FitParameter, f64), String> {
    let (quantity, value) = named(text, "NAME=VALUE, for example K_A=0.1")?;
    Ok((quantity, number(value)?))
}

fn bounds(text: &str) -> Result<(FitParameter, [f64; 2]), String> {
    const EXAMPLE: &str = "NAME=LOW..HIGH, for example K_A=0..0.5, K_A=0.. or P_0=..4.2";
    let (quantity, range) = named(text, EXAMPLE)?;
    let (low, high) = range.split_once("..").ok_or_else(|| format!("write {EXAMPLE}"))?;
    let end = |text: &str, missing: f64| if text.is_empty() { Ok(missing) } else { number(text) };
    match [end(low, f64::NEG_INFINITY)?, end(high, f64::INFINITY)?] {
        [f64::NEG_INFINITY, f64::INFINITY] => Err("give at least one end".into()),
        [low, high] if low >= high => Err(format!("the lower end {low} is not below the upper end {high}")),
        ends => Ok((quantity, ends)),
    }
}

fn prior(text: &str) -> Result<(FitParameter, Prior), String> {
    const EXAMPLE: &str = "NAME=MEAN±SD, for example P_0=3.9±0.2 or P_0=3.9,0.2";
    let (quantity, value) = named(text, EXAMPLE)?;
    let parts = ["±", "+-", ","].into_iter().find_map(|sign| value.split_once(sign));
    let (mean, deviation) =
        parts.ok_or_else(|| format!("the standard deviation is missing; write {EXAMPLE}"))?;
    let (mean, standard_deviation) = (number(mean)?, number(deviation)?);
    if standard_deviation <= 0.0 {
        return Err(format!("the standard deviation is {standard_deviation}, but it must be above zero"));
    }
    Ok((quantity, Prior { mean, standard_deviation }))
}

fn once<T: Copy>(
    option: &str,
    entries: impl IntoIterator<Item = (FitParameter, T)>,
) -> Result<BTreeMap<FitParameter, T>, Failure> {
    let mut table = BTreeMap::new();
    for (quantity, value) in entries {
        if table.insert(quantity, value).is_some() {
            return Err(Failure::new(format!("{option}: {} is given twice", quantity.name()))
                .with_hint("give each parameter at most once; --stable bounds K_A and K_P"));
        }
    }
    Ok(table)
}

impl ConstraintArguments {
    /// What is known of the parameters, in the units of the data.
    pub fn constraints(&self) -> Result<Constraints, Failure> {
        let positive = [FitParameter::AreaElasticity, FitParameter::PerimeterElasticity];
        let stable = positive.map(|quantity| (quantity, [0.0, f64::INFINITY]));
        let bounds = self.bounds.iter().copied().chain(stable.into_iter().filter(|_| self.stable));
        let constraints = Constraints {
            fixed: once("--fix", self.fix.iter().copied())?,
            bounds: once("--bounds", bounds)?,
            priors: once("--prior", self.prior.iter().copied())?,
        };
        if let Some(held) = constraints.priors.keys().find(|q| constraints.fixed.contains_key(q)) {
            return Err(Failure::new(format!("--prior: {} is held by --fix", held.name()))
                .with_hint("leave out one of the two"));
        }
        CoefficientSpace::new(&constraints)?;
        Ok(constraints)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_may_lack_an_end_and_be_negative() {
        let ends = |text| bounds(text).map(|(_, ends)| ends);
        assert_eq!(ends("K_A=0..0.5"), Ok([0.0, 0.5]));
        assert_eq!(ends("alpha=-3..-1.5"), Ok([-3.0, -1.5]));
        assert_eq!(ends("K_P=0.."), Ok([0.0, f64::INFINITY]));
        assert_eq!(ends("P_0=..4.2"), Ok([f64::NEG_INFINITY, 4.2]));
        for wrong in ["K_A", "K_A=..", "K_A=2..1", "K_A=1..1", "K_A=1", "K_A=a..b", "K_B=0..", "K_A=nan.."] {
            assert!(ends(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn priors_may_be_written_in_three_ways() {
        let expected = Prior { mean: -3.9, standard_deviation: 0.2 };
        for text in ["alpha=-3.9±0.2", "alpha=-3.9 ± 0.2", "alpha=-3.9+-0.2", "alpha=-3.9,0.2"] {
            assert_eq!(prior(text), Ok((FitParameter::Chirality, expected)), "{text}");
        }
        for wrong in ["alpha=1", "alpha=1±0", "alpha=1±-2", "alpha=1±x", "alpha", "beta=1±1", "alpha=inf±1"]
        {
            assert!(prior(wrong).is_err(), "{wrong}");
        }
    }
}
