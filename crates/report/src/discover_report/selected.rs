//! The effects that were added.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::EffectKind;
use crate::infer_report::Parameter;

/// One effect that was added to the base model.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SelectedEffect {
    /// ID of the effect, for example `density_gradient`.
    pub effect: String,
    /// Contribution of the effect as a formula in plain text.
    pub formula: String,
    /// What the effect means, for a reader who does not know the model.
    pub meaning: String,
    /// Family of the effect.
    pub kind: EffectKind,
    /// Fitted coefficients, in units of the data.
    pub coefficients: Vec<EffectCoefficient>,
    /// 95 % interval of each coefficient; an end that is `null` is not bounded by the data.
    pub ci95: Vec<[f64; 2]>,
    /// Probability that any candidate has a statistic at least as large if nothing is missing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub p_adjusted: f64,
    /// Share of the excess, which is what the base model leaves beyond noise, that the effect explains.
    pub share_of_excess: f64,
    /// Other effects that these data cannot tell apart from it.
    pub class: Vec<String>,
    /// For each effect of `class`, a sentence on the measurement that would tell the two apart.
    pub told_apart_by: BTreeMap<String, String>,
}

/// One coefficient of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EffectCoefficient {
    /// Name or axis of the coefficient; empty if it is the only one of an effect.
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
