//! One search, and what it came to beside the truth.

use super::added::Sample;
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;
use voronudge_infer::discover::{Discovery, Search, Verdict, discover};
use voronudge_infer::{Constraints, CrossValidation, Estimate, KnownNoise, Request, Unkept, infer};
use voronudge_model::effect::Kind;

/// What a search came to.
pub struct Found {
    pub seed: u64,
    pub discovery: Discovery,
    /// Ids of the effects in the data.
    pub truth: Vec<&'static str>,
    /// Size of the first of them beyond the base model.
    pub beyond: f64,
    /// Coefficient over the truth, along the truth, and whether the interval of each coefficient covers; if the
    /// truth is one effect, fitted as such.
    pub coefficient: Option<(f64, Vec<bool>)>,
    pub seconds: f64,
}

impl Found {
    /// Searches a data set with all parameters free.
    pub fn search(
        sample: &Sample,
        told: KnownNoise,
        null_sets: Option<usize>,
        seed: u64,
    ) -> Result<Self, Box<dyn Error>> {
        // The error on velocities held out is of interest where it should fall.
        let cross_validation = match sample.added.as_slice() {
            [] => CrossValidation::Skipped,
            _ => CrossValidation::Done,
        };
        let fit = Request { noise: told, cross_validation, ..Request::new(Constraints::default()) };
        let search = Search { null_sets, identities: sample.identities.clone(), ..Search::new(fit.clone()) };
        let begun = Instant::now();
        let discovery = discover(&sample.frames, &search, &mut Unkept, &mut |_| ControlFlow::Continue(()))?;
        let seconds = begun.elapsed().as_secs_f64();
        let coefficient = match sample.added.as_slice() {
            [added] => {
                let structure = fit.structure.with(&added.columns);
                let cross_validation = CrossValidation::Skipped;
                let fitted =
                    infer(&sample.frames, &Request { structure, cross_validation, ..fit }, &mut |_| {
                        ControlFlow::Continue(())
                    })?;
                Some(against(&added.coefficients, &fitted.effects))
            }
            _ => None,
        };
        Ok(Self {
            seed,
            discovery,
            truth: sample.added.iter().map(|added| added.effect.id).collect(),
            beyond: sample.added.first().map_or(0.0, |added| added.beyond),
            coefficient,
            seconds,
        })
    }

    /// Whether effects were added.
    pub fn selected(&self) -> bool {
        !self.discovery.selected.is_empty()
    }

    pub fn verdict_is(&self, verdict: Verdict) -> bool {
        self.discovery.verdict == verdict
    }

    /// Whether the effect with the smallest p is one in the data.
    pub fn ranked_first(&self) -> bool {
        let first = self.discovery.ranking.iter().find(|own| own.effect.kind != Kind::Description);
        first.is_some_and(|own| self.truth.contains(&own.effect.id))
    }

    /// Whether the effects added are those in the data, in any order.
    pub fn exact(&self) -> bool {
        self.discovery.selected.len() == self.truth.len()
            && self.discovery.selected.iter().all(|own| self.truth.contains(&own.effect.id))
    }

    /// Whether for each effect in the data there is one added that it cannot be told from, and no other.
    pub fn exact_up_to_class(&self) -> bool {
        self.discovery.selected.len() == self.truth.len() && self.in_classes()
    }

    /// Whether each effect in the data was added or cannot be told from one that was.
    pub fn in_classes(&self) -> bool {
        let holds = |id: &str| {
            let mut selected = self.discovery.selected.iter();
            selected.any(|own| own.effect.id == id || own.class.iter().any(|other| other.id == id))
        };
        self.truth.iter().all(|id| holds(id))
    }

    /// Whether an effect that is not in the data was added and nothing is said to be as good.
    pub fn wrong_alone(&self) -> bool {
        self.discovery.selected.iter().any(|own| own.class.is_empty() && !self.truth.contains(&own.effect.id))
    }

    /// Whether the held-out error falls.
    pub fn error_falls(&self) -> bool {
        self.discovery.gain.is_some_and(|[gain, _]| gain > 0.0)
    }

    /// χ² of the last model per degree of freedom.
    pub fn misfit(&self) -> f64 {
        let fit = &self.discovery.after.inference;
        fit.objective / fit.expected_objective
    }
}

/// Estimates along the true coefficients, and whether their intervals cover.
fn against(truth: &[f64], estimates: &[Estimate]) -> (f64, Vec<bool>) {
    let squared: f64 = truth.iter().map(|c| c * c).sum();
    let along: f64 = truth.iter().zip(estimates).map(|(c, own)| c * own.value).sum();
    (along / squared, truth.iter().zip(estimates).map(|(c, own)| own.covers(*c)).collect())
}

/// Everything that helps to see why.
impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let d = &self.discovery;
        write!(f, "seed {}: {:?}, χ² {:.3}", self.seed, d.verdict, self.misfit())?;
        write!(f, " (before {:.3}", d.before.inference.objective / d.before.inference.expected_objective)?;
        write!(f, "), structure p {:.2e}, share {:.2}", d.after.diagnostics.structure.p, d.share_of_excess)?;
        for (name, gain) in [("gain", d.gain), ("−2 log p", d.likelihood_gain)] {
            if let Some([gain, error]) = gain {
                write!(f, ", {name} {gain:.4} ± {error:.4}")?;
            }
        }
        for own in &d.selected {
            let class: Vec<&str> = own.class.iter().map(|other| other.id).collect();
            write!(f, "\n    + {} (adjusted p {:.1e}, size {:.3}", own.effect.id, own.adjusted_p, own.size)?;
            write!(f, ", share {:.2}) ~ [{}]", own.share_of_excess, class.join(", "))?;
        }
        for own in d.ranking.iter().take(6) {
            write!(f, "\n    {} p {:.1e}, adjusted {:.1e}", own.effect.id, own.p, own.adjusted_p)?;
            write!(f, ", T {:.1} of {}, size {:.3}", own.statistic, own.dimension, own.size)?;
            write!(f, ", limit {:.3}: {:?}", own.detection_limit, own.fate)?;
        }
        for own in d.ranking.iter().skip(6).filter(|own| self.truth.contains(&own.effect.id)) {
            write!(f, "\n    truth {} p {:.1e}, size {:.3}: {:?}", own.effect.id, own.p, own.size, own.fate)?;
        }
        if let Some(p) = d.null_sets.smallest_p.first() {
            write!(f, "\n    {} null sets, smallest p {p:.1e}", d.null_sets.smallest_p.len())?;
        }
        if let Some(described) = &d.description {
            write!(f, "\n    described by {}", described.effect.id)?;
        }
        Ok(())
    }
}
