//! What would be known if more, or better, had been measured.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

/// Other measurements by name, in the order in which they are told, with words for them.
pub const DESIGNS: [(&str, &str); 4] = [
    ("twice_the_frames", "twice the frames"),
    ("half_the_interval", "half the interval"),
    ("half_the_position_noise", "half the error of positions"),
    ("twice_the_field", "twice the field of view"),
];

/// What would be known of the parameters, and of effects, from other measurements.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct ProspectsReport {
    /// What to measure next, in a sentence; empty if there is nothing to advise.
    pub words: String,
    /// What is least certain: the name of a quantity, or of two effects that the data cannot tell apart; `null` if there is nothing.
    pub least_certain: Option<String>,
    /// The measurement that would make `least_certain` most certain; `null` if none does.
    #[schemars(extend("enum" = ["twice_the_frames", "half_the_interval", "half_the_position_noise", "twice_the_field", null]))]
    pub recommended: Option<String>,
    /// Standard error of `least_certain` with that measurement, as a share of the present one; `null` where `recommended` is `null`.
    #[schemars(range(min = 0.0))]
    pub share: Option<f64>,
    /// The parameters that were fitted, and the coefficients of effects, by names such as `drift along x`.
    pub quantities: Vec<ProspectOf>,
    /// Pairs of effects that the data cannot tell apart; only with `discover`.
    pub ambiguities: Vec<AmbiguityReport>,
}

/// A quantity, and how well it would be known from other measurements.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ProspectOf {
    /// Name of the parameter, or of the effect and its coefficient.
    pub name: String,
    /// Value of the quantity.
    pub value: f64,
    /// Present standard error of the quantity.
    #[schemars(range(min = 0.0))]
    pub standard_error: f64,
    /// Unit of the value and of all standard errors.
    pub unit: String,
    /// Expected standard error with each other measurement, by name of the measurement.
    #[schemars(extend("propertyNames" = {"enum": DESIGNS.map(|(name, _)| name)}))]
    pub expected: BTreeMap<String, f64>,
}

/// Two effects that the data cannot tell apart.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct AmbiguityReport {
    /// The effect that was added.
    pub effect: String,
    /// The effect that could take its place.
    pub other: String,
    /// By how many standard errors `effect` differs from zero when `other` is in the model, too.
    #[schemars(range(min = 0.0))]
    pub separation: f64,
    /// The same with each other measurement, by name of the measurement.
    #[schemars(extend("propertyNames" = {"enum": DESIGNS.map(|(name, _)| name)}))]
    pub expected: BTreeMap<String, f64>,
}

impl AmbiguityReport {
    /// What it is called where something is least certain.
    pub fn name(&self) -> String {
        format!("{} or {}", self.effect, self.other)
    }
}
