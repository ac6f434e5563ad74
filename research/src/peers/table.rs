//! What the methods come to, side by side.

use super::set::{BASE, KINDS, Set};
use crate::study::quartiles;
use std::collections::BTreeSet;
use std::error::Error;
use std::fmt;

/// Who found something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Ours,
    RivalRobust,
    RivalClean,
    RivalParametric,
    LeastSquares,
}

impl Method {
    const ALL: [Self; 5] =
        [Self::Ours, Self::RivalRobust, Self::RivalClean, Self::RivalParametric, Self::LeastSquares];

    /// Those of the rival, with their names in what its script writes.
    pub const OF_RIVAL: [(Self, &str); 3] =
        [(Self::RivalRobust, "robust"), (Self::RivalClean, "clean"), (Self::RivalParametric, "parametric")];

    fn name(self) -> &'static str {
        match self {
            Self::Ours => "voronudge discover",
            Self::RivalRobust => "SFI, linear, robust, PASTIS",
            Self::RivalClean => "SFI, linear, for clean data, PASTIS",
            Self::RivalParametric => "SFI, errors modelled, PASTIS",
            Self::LeastSquares => "least squares, cross-validated",
        }
    }
}

/// What a method found in a set.
pub struct Found {
    method: Method,
    /// Whether an effect acts.
    lacks: bool,
    /// What else was found; none if the method failed.
    told: Option<Told>,
}

struct Told {
    /// Whether the effect that acts is among those found, or nothing was, if none acts.
    hit: bool,
    /// Effects found that do not act.
    false_ones: usize,
    /// Relative errors of K_P α and of P₀ after.
    errors: [f64; 2],
    /// Share of the true velocities held out that is missed, before and after.
    missed: [f64; 2],
}

impl Found {
    /// From the coefficients of all columns before and after; none if the method failed.
    pub fn new(
        set: &Set,
        names: &[&str],
        method: Method,
        coefficients: Option<[Vec<f64>; 2]>,
    ) -> Result<Self, Box<dyn Error>> {
        let told = match coefficients.filter(|both| both.iter().flatten().all(|c| c.is_finite())) {
            None => None,
            Some([before, after]) => {
                let found: BTreeSet<&str> =
                    (BASE.len()..names.len()).filter(|k| after[*k] != 0.0).map(|k| names[k]).collect();
                let false_ones = found.iter().filter(|name| Some(**name) != set.effect).count();
                let relative = |value: f64, truth: f64| (value / truth - 1.0).abs();
                let errors = [
                    relative(after[3], set.truth[3]),
                    relative(after[1] / after[2], set.truth[1] / set.truth[2]),
                ];
                Some(Told {
                    hit: set.effect.map_or(found.is_empty(), |effect| found.contains(effect)),
                    false_ones,
                    errors: errors.map(|error| if error.is_finite() { error } else { 1.0 }),
                    missed: [set.error(&before)?, set.error(&after)?],
                })
            }
        };
        Ok(Self { method, lacks: set.effect.is_some(), told })
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.told {
            None => write!(f, "{} failed", self.method.name()),
            Some(Told { hit, false_ones, errors, missed }) => write!(
                f,
                "{}: right {hit}, false {false_ones}, K_P α {:.3}, P_0 {:.3}, missed {:.4} -> {:.4}",
                self.method.name(),
                errors[0],
                errors[1],
                missed[0],
                missed[1]
            ),
        }
    }
}

/// Tables for sets in which nothing is missing, and for those with an effect.
pub fn print(all: &[(&str, Found)]) {
    for lacks in [false, true] {
        println!("\n### {}\n", if lacks { "An effect acts" } else { "Nothing is missing" });
        let told = if lacks { "effect found" } else { "sets without a finding" };
        println!(
            "| sets | method | {told} | false findings in all | error of K_P α, % | of P₀, % | missed before, % | after, % |"
        );
        println!("|---|---|---|---|---|---|---|---|");
        for kind in KINDS {
            for method in Method::ALL {
                let own = all
                    .iter()
                    .filter(|(name, own)| *name == kind.name && own.method == method && own.lacks == lacks);
                let own: Vec<&Found> = own.map(|(_, own)| own).collect();
                if own.is_empty() {
                    continue;
                }
                let told: Vec<&Told> = own.iter().filter_map(|own| own.told.as_ref()).collect();
                let median = |of: &dyn Fn(&Told) -> f64| {
                    let [_, middle, _] = quartiles(told.iter().map(|told| of(told)).collect());
                    if middle > 10.0 { "> 1000".into() } else { format!("{:.2}", 100.0 * middle) }
                };
                println!(
                    "| {} | {} | {} of {} | {} | {} | {} | {} | {} |",
                    kind.name,
                    method.name(),
                    told.iter().filter(|told| told.hit).count(),
                    own.len(),
                    told.iter().map(|told| told.false_ones).sum::<usize>(),
                    median(&|told| told.errors[0]),
                    median(&|told| told.errors[1]),
                    median(&|told| told.missed[0]),
                    median(&|told| told.missed[1]),
                );
            }
        }
    }
}
