//! The parameters of a model that a report is of.

use schemars::JsonSchema;
use serde::Serialize;

/// Parameters under the names of the interface, in units of the data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ModelParameters {
    /// Area elasticity.
    pub K_A: f64,
    /// Perimeter elasticity.
    pub K_P: f64,
    /// Preferred perimeter.
    pub P_0: f64,
    /// Preferred area.
    pub A_0: f64,
    /// Chirality.
    pub alpha: f64,
}
