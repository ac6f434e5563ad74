//! How well the parameters are known, beyond their intervals.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

/// One direction in the space of parameters and how well the data determine it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EigenDirection {
    /// One over the variance along it.
    pub eigenvalue: f64,
    /// Components of the unit vector by parameter.
    pub direction: BTreeMap<String, f64>,
    /// The direction in a sentence.
    pub words: String,
}

/// The profile likelihood of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ProfileResult {
    /// Name of the parameter.
    pub parameter: String,
    /// Its values, ascending, the estimate among them.
    pub values: Vec<f64>,
    /// Rise of −2 log likelihood at these values above the least, everything else fitted again.
    pub rise: Vec<f64>,
    /// Where the rise crosses 3.84; `null` where it does not within the values.
    pub interval: [Option<f64>; 2],
}

/// The rise of −2 log likelihood over two parameters.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LandscapeResult {
    /// Names of the two parameters.
    pub parameters: [String; 2],
    /// Their values, ascending.
    pub values: [Vec<f64>; 2],
    /// Rise with nudges and other parameters as fitted: one row for each value of the second parameter.
    pub fixed: Vec<Vec<f64>>,
    /// The same with nudges and other parameters fitted again at every point.
    pub refitted: Vec<Vec<f64>>,
}

/// Estimates from synthetic data sets that the fit itself could have made.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BootstrapResult {
    /// Number of data sets fitted.
    pub replicates: usize,
    /// Number of data sets that could not be fitted.
    pub failed: usize,
    /// Central 95 % of the estimates of each free parameter; `null` with fewer than 40 data sets.
    pub intervals: BTreeMap<String, Option<[f64; 2]>>,
    /// Standard deviation of the estimates of each free parameter.
    pub standard_deviations: BTreeMap<String, f64>,
}
