//! The parameters of a model that a report is of.

use schemars::JsonSchema;
use serde::Serialize;

/// Parameters of the model, named as in files and options, in units of the data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ModelParameters {
    /// Area elasticity, in 1/(length² time).
    pub K_A: f64,
    /// Perimeter elasticity, in 1/time.
    pub K_P: f64,
    /// Preferred perimeter, in units of length.
    pub P_0: f64,
    /// Preferred area, in length².
    pub A_0: f64,
    /// Chirality α, dimensionless.
    pub alpha: f64,
}
