//! Cells that crawl.

use super::Parameter;
use schemars::JsonSchema;
use serde::Serialize;

/// Polarity of the cells: a velocity that each cell has of its own.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ActivityReport {
    /// Speed of self-propulsion; its `ci95` begins at zero if the data do not show a polarity.
    pub v_0: Parameter,
    /// Rate of rotational diffusion; its `ci95` is `null` if the data do not show a polarity.
    pub D_r: Parameter,
    /// Rate of alignment with the polarities of the neighbours, with `--align`; `null` otherwise. Its `ci95` is `null` where that of `D_r` is.
    pub J: Option<Parameter>,
    /// Fall of −2 log L relative to the likeliest fit of cells that do not align; `null` if it was not requested.
    pub evidence_of_alignment: Option<f64>,
    /// Contact inhibition: how fast polarities turn away from contacts; `null` if it was not requested.
    pub b: Option<Parameter>,
    /// Fall of −2 log L relative to cells without contact inhibition; `null` if it was not requested.
    pub evidence_of_contact_inhibition: Option<f64>,
    /// Rate at which polarities turn towards the velocity that the model gives; `null` if it was not requested.
    pub kappa: Option<Parameter>,
    /// Fall of −2 log L relative to cells without velocity alignment; `null` if it was not requested.
    pub evidence_of_velocity_alignment: Option<f64>,
    /// Correlation between the polarity averaged over one interval between frames and that averaged over the next.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub correlation: f64,
}
