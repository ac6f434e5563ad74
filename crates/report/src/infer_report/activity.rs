//! Cells that crawl.

use super::Parameter;
use schemars::JsonSchema;
use serde::Serialize;

/// The polarity of the cells: a velocity that each has of itself.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ActivityReport {
    /// Speed of self-propulsion; its `ci95` begins at zero if the data do not show a polarity.
    pub v_0: Parameter,
    /// Rate of rotational diffusion; its `ci95` is `null` if the data do not show a polarity.
    pub D_r: Parameter,
    /// Rate of alignment, with `--align`; `null` otherwise. Its `ci95` is `null` where that of `D_r` is.
    pub J: Option<Parameter>,
    /// By how much −2 log L falls from the likeliest fit of cells that do not align; `null` if it was not asked for.
    pub evidence_of_alignment: Option<f64>,
    /// How fast polarities turn away from contacts; `null` if it was not asked for.
    pub b: Option<Parameter>,
    /// By how much −2 log L falls from cells that do not; `null` likewise.
    pub evidence_of_contact_inhibition: Option<f64>,
    /// Rate at which polarities turn towards the velocity of the model; `null` if it was not asked for.
    pub kappa: Option<Parameter>,
    /// By how much −2 log L falls from cells that do not; `null` likewise.
    pub evidence_of_velocity_alignment: Option<f64>,
    /// Correlation of the mean polarity over the time between two frames with that over the next.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub correlation: f64,
}
