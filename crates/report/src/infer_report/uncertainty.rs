//! How well the parameters are known, beyond their intervals.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

/// A direction in the space of parameters, and how well the data determine it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EigenDirection {
    /// Inverse of the variance along the direction.
    pub eigenvalue: f64,
    /// Components of the unit vector along the direction, by parameter.
    pub direction: BTreeMap<String, f64>,
    /// The direction in a sentence.
    pub words: String,
}

/// The profile likelihood of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ProfileResult {
    /// Name of the parameter.
    pub parameter: String,
    /// Values of the parameter, ascending and including the estimate, in units of the data.
    pub values: Vec<f64>,
    /// Rise of −2 log likelihood above its minimum at each of these values, with everything else fitted again.
    pub rise: Vec<f64>,
    /// Values of the parameter at which the rise crosses 3.84; an end is `null` where it does not cross within `values`.
    pub interval: [Option<f64>; 2],
}

/// The rise of −2 log likelihood over two parameters.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LandscapeResult {
    /// Names of the two parameters.
    pub parameters: [String; 2],
    /// Values of each of the two parameters, ascending, in units of the data.
    pub values: [Vec<f64>; 2],
    /// Rise with nudges and other parameters as fitted: one row for each value of the second parameter, one column for each value of the first.
    pub fixed: Vec<Vec<f64>>,
    /// The same with nudges and other parameters fitted again at every point.
    pub refitted: Vec<Vec<f64>>,
}

/// Estimates from synthetic data sets that were generated from the fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BootstrapResult {
    /// Number of data sets fitted.
    pub replicates: usize,
    /// Number of data sets that could not be fitted.
    pub failed: usize,
    /// Central 95 % of the estimates of each free parameter, by name, in units of the data; `null` with fewer than 40 data sets.
    pub intervals: BTreeMap<String, Option<[f64; 2]>>,
    /// Standard deviation of the estimates of each free parameter, by name, in units of the data.
    pub standard_deviations: BTreeMap<String, f64>,
}
