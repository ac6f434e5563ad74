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

/// What would be known of the parameters, and of effects, with other measurements.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct ProspectsReport {
    /// What to measure next, in a sentence; empty if there is nothing to advise.
    pub words: String,
    /// What is least certain: the name of a quantity, or of two effects that the data cannot tell apart; `null` if nothing is.
    pub least_certain: Option<String>,
    /// The measurement that makes that most certain; `null` if none does.
    #[schemars(extend("enum" = ["twice_the_frames", "half_the_interval", "half_the_position_noise", "twice_the_field", null]))]
    pub recommended: Option<String>,
    /// Its standard error then, as a share of the present one; `null` likewise.
    #[schemars(range(min = 0.0))]
    pub share: Option<f64>,
    /// Parameters that were fitted and coefficients of effects, by their names, such as `drift along x`.
    pub quantities: Vec<ProspectOf>,
    /// Effects that the data cannot tell apart, of `discover`.
    pub ambiguities: Vec<AmbiguityReport>,
}

/// A quantity and how well it would be known.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ProspectOf {
    /// The name of the parameter, or of the effect and its coefficient.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its present standard error.
    #[schemars(range(min = 0.0))]
    pub standard_error: f64,
    /// Unit of both.
    pub unit: String,
    /// Standard errors with other measurements, by name of the measurement.
    #[schemars(extend("propertyNames" = {"enum": DESIGNS.map(|(name, _)| name)}))]
    pub expected: BTreeMap<String, f64>,
}

/// Two effects that the data cannot tell apart.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct AmbiguityReport {
    /// The effect that was added.
    pub effect: String,
    /// The one that could stand in its place.
    pub other: String,
    /// By how many standard errors the first stands out with the other in the model.
    #[schemars(range(min = 0.0))]
    pub separation: f64,
    /// The same with other measurements, by name of the measurement.
    #[schemars(extend("propertyNames" = {"enum": DESIGNS.map(|(name, _)| name)}))]
    pub expected: BTreeMap<String, f64>,
}

impl AmbiguityReport {
    /// What it is called where something is least certain.
    pub fn name(&self) -> String {
        format!("{} or {}", self.effect, self.other)
    }
}
