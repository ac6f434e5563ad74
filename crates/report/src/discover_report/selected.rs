//! The effects that were added.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::EffectKind;
use crate::infer_report::Parameter;

/// One effect that was added to the base model.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SelectedEffect {
    /// Id of the effect, for example `density_gradient`.
    pub effect: String,
    /// Its contribution as a formula in plain text.
    pub formula: String,
    /// What it means, for a reader who does not know the model.
    pub meaning: String,
    /// The family it belongs to.
    pub kind: EffectKind,
    /// Its fitted coefficients, in the units of the data.
    pub coefficients: Vec<EffectCoefficient>,
    /// 95 % interval of each coefficient; an end that is `null` is not bounded by the data.
    pub ci95: Vec<[f64; 2]>,
    /// Probability of so large a statistic of any candidate if nothing is missing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p_adjusted: f64,
    /// Share of what the base model leaves beyond noise that the effect explains.
    pub share_of_excess: f64,
    /// Effects that these data cannot tell from it, without itself.
    pub class: Vec<String>,
    /// For each effect of `class`, a sentence on the measurement that would tell the two apart.
    pub told_apart_by: BTreeMap<String, String>,
}

/// One coefficient of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EffectCoefficient {
    /// Name or axis; empty for the only coefficient of an effect.
    pub name: String,
    /// Fitted value.
    pub value: f64,
    /// Unit; empty if dimensionless.
    pub unit: String,
}

impl SelectedEffect {
    /// The coefficients with their intervals, named for a table, as parameters are.
    #[must_use]
    pub fn parameters(&self) -> Vec<(String, Parameter)> {
        let ends = self.ci95.iter().copied().map(Some).chain(std::iter::repeat(None));
        let named = |(coefficient, ci95): (&EffectCoefficient, Option<[f64; 2]>)| {
            let name = [self.effect.as_str(), &coefficient.name].join(" ").trim_end().to_owned();
            let parameter = Parameter {
                value: coefficient.value,
                ci95,
                fixed: false,
                unit: coefficient.unit.clone(),
                words: self.meaning.clone(),
            };
            (name, parameter)
        };
        self.coefficients.iter().zip(ends).map(named).collect()
    }
}
