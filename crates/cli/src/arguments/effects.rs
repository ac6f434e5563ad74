//! Effects beyond the base model, by their id.

use crate::failure::Failure;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use voronudge_geometry::{Certificate, Domain, Tessellation, Vector};
use voronudge_model::{Effect, Environment, Model};

#[derive(Debug, Args)]
#[command(next_help_heading = "Model")]
pub(crate) struct EffectArguments {
    /// Add an effect beyond the base model, with its coefficients in units of the data: `drift=0.1,0`. The ids are
    /// listed in docs/effects.md. May be repeated.
    #[arg(long = "effect", value_name = "ID=VALUE[,VALUE…]", allow_hyphen_values = true)]
    effects: Vec<String>,
}

/// Effects with their coefficients.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
#[serde(transparent)]
pub(crate) struct ChosenEffects(BTreeMap<&'static str, Vec<f64>>);

impl EffectArguments {
    /// The effects as typed: each known, with finite coefficients.
    pub fn resolve(&self) -> Result<ChosenEffects, Failure> {
        let mut chosen = ChosenEffects::default();
        for text in &self.effects {
            let fault = |message: String| Failure::new(format!("--effect {text}: {message}"));
            let Some((id, values)) = text.split_once('=') else {
                return Err(fault("no coefficient is given".into()).with_hint("write --effect ID=VALUE"));
            };
            let effect = effect(id).map_err(|failure| failure.at(format!("--effect {text}")))?;
            let values =
                values.split(',').map(|value| value.trim().parse().ok().filter(|v: &f64| v.is_finite()));
            let values = values.collect::<Option<Vec<f64>>>().ok_or_else(|| {
                fault("a coefficient is not a finite number".into())
                    .with_hint("separate several coefficients by commas, as in drift=0.1,-0.2")
            })?;
            if chosen.0.insert(effect.id, values).is_some() {
                return Err(
                    fault("the effect is given twice".into()).with_hint("give all its coefficients at once")
                );
            }
        }
        Ok(chosen)
    }
}

impl ChosenEffects {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The coefficients of an effect, which is no longer among them.
    pub fn take(&mut self, id: &str) -> Option<Vec<f64>> {
        self.0.remove(id)
    }

    /// Ids with coefficients.
    pub fn named(&self) -> BTreeMap<String, Vec<f64>> {
        self.0.iter().map(|(id, values)| ((*id).to_owned(), values.clone())).collect()
    }

    /// The model with these effects in an environment.
    pub fn add_to(
        &self,
        model: Model<f64>,
        environment: Environment,
        domain: Domain,
    ) -> Result<Model<f64>, Failure> {
        let mut model = model;
        for (id, values) in &self.0 {
            let Some(effect) = Effect::from_id(id) else { continue };
            model = (effect.add_to(model, &environment, domain, values))
                .map_err(|error| Failure::new(format!("--effect {id}: {error}")).with_hint(error.hint()))?;
        }
        Ok(model.within(&Arc::new(environment)))
    }
}

/// [`Environment::around`] positions, or a failure.
pub(crate) fn environment(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    view: &Certificate,
) -> Result<Environment, Failure> {
    Environment::around(tessellation, positions, view)
        .map_err(|error| Failure::new(error.to_string()).with_hint("check the positions"))
}

/// The effect of an id.
pub(crate) fn effect(id: &str) -> Result<&'static Effect, Failure> {
    Effect::from_id(id)
        .ok_or_else(|| Failure::new(format!("there is no effect {id:?}")).with_hint(suggestion(id)))
}

/// The id nearest to what was typed, and all.
fn suggestion(typed: &str) -> String {
    let nearest = Effect::all().iter().map(|effect| (distance(typed, effect.id), effect.id)).min();
    let ids: Vec<&str> = Effect::all().iter().map(|effect| effect.id).collect();
    match nearest {
        Some((distance, id)) if distance <= 1 + typed.len() / 3 => {
            format!("did you mean {id}? The effects are {}", ids.join(", "))
        }
        _ => format!("the effects are {}", ids.join(", ")),
    }
}

/// Number of letters to insert, delete or replace (Levenshtein).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use voronudge_geometry::PeriodicBox;

    fn resolve(typed: &[&str]) -> Result<ChosenEffects, String> {
        let effects = typed.iter().map(|text| (*text).to_owned()).collect();
        EffectArguments { effects }.resolve().map_err(|failure| failure.to_string())
    }

    #[test]
    fn unknown_ids_are_refused_with_the_nearest() {
        let error = resolve(&["nematic_stres=1"]).unwrap_err();
        assert!(error.contains("did you mean nematic_stress?") && error.contains("internal_drag"), "{error}");
        assert!(!resolve(&["phlogiston=1"]).unwrap_err().contains("did you mean"));
        for fault in ["drift", "drift=", "drift=1,x", "drift=inf,0"] {
            assert!(resolve(&[fault]).unwrap_err().contains("hint"), "{fault}");
        }
        assert!(resolve(&["drift=1,0", "drift=0,1"]).unwrap_err().contains("twice"));
    }

    #[test]
    fn coefficients_are_counted_and_reasons_given() {
        let domain = Domain::Periodic(PeriodicBox::new([4.0, 4.0]).unwrap());
        let add = |typed: &str| {
            let model = Model::with_coefficients(&[], &[]);
            let added = resolve(&[typed]).unwrap().add_to(model, Environment::default(), domain);
            added.map_err(|failure| failure.to_string())
        };
        assert_eq!(add("drift=-1,0.5").unwrap().terms.len(), 2);
        assert_eq!(add("internal_drag=0.5").unwrap().responses.len(), 1);
        assert!(add("drift=1").unwrap_err().contains("c₁, c₂"));
        assert!(add("label_parameter=1,2,3").unwrap_err().contains("no labels were given"));
        assert!(add("rotation=1").unwrap_err().contains("not periodic"));
    }
}
