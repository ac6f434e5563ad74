//! What was said of the parameters before the fit.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

/// Parameters held, bounded or known to some precision, by name and as given.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct GivenConstraints {
    /// Values of parameters held, in the units of the data, and so below.
    pub fixed: BTreeMap<String, f64>,
    /// Lower and upper bounds; an end that is `null` is no bound.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// Gaussian priors.
    pub priors: BTreeMap<String, GivenPrior>,
}

/// A Gaussian prior.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct GivenPrior {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}
