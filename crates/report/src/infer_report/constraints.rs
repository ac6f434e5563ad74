//! What was said of the parameters before the fit.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

/// Constraints on the parameters as given, by name of the parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct GivenConstraints {
    /// Values of the parameters that are held fixed, in units of the data, as are all values below.
    pub fixed: BTreeMap<String, f64>,
    /// Lower and upper bounds; at an end that is `null` there is no bound.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// Gaussian priors.
    pub priors: BTreeMap<String, GivenPrior>,
}

/// A Gaussian prior.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct GivenPrior {
    /// Mean of the prior.
    pub mean: f64,
    /// Standard deviation of the prior.
    pub standard_deviation: f64,
}
