//! One fitted model: parameters, errors, noise, nudges.

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::{EigenDirection, Fit, MeanRemoved, Noise, Nudge, Parameters};

/// One fitted model: what `infer` reports, for the base model and for the model with the effects.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModelFit {
    /// The nudged estimate.
    pub parameters: Parameters,
    /// Normalised errors.
    pub nmse: ModelNmse,
    /// What measurement noise alone makes of `nmse.un_nudged` and of the held-out error if the model
    /// is right; `null` where positions are not those of sites.
    pub noise_floor_nmse: f64,
    /// Measurement noise; where it is estimated, an upper bound as long as something is missing.
    pub noise: Noise,
    /// The nudges.
    pub nudge: Nudge,
    /// Principal axes of the covariance of all coefficients, stiffest first.
    pub identifiability: Vec<EigenDirection>,
    /// Penalised χ² over its degrees of freedom; one if model and noise levels are right.
    pub chi_square_per_dof: f64,
    /// Course of the fit; `null` where it is not kept.
    pub fit: Option<Fit>,
}

/// Normalised mean square errors Σ‖v − v̂‖²/Σ‖v‖² over the cells used.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModelNmse {
    /// Parameters by least squares at the measured positions.
    pub naive: f64,
    /// Nudged parameters at the nudged positions (the fit's own data). It falls with every effect, needed or not: no measure of success.
    pub nudged: f64,
    /// Nudged parameters at the measured positions.
    pub un_nudged: f64,
    /// Blocks of cells predicted from fits that did not see their velocities; `null` if not computed.
    pub cross_validated: Option<HeldOutError>,
    /// Frames predicted from fits that did not see them; `null` if not computed.
    pub held_out_frames: Option<HeldOutError>,
    /// Which mean velocity was removed from the data.
    pub mean_removed: MeanRemoved,
    /// Degree of the polynomials of the position that are no concern of the model; `null` if no background
    /// is allowed.
    pub background: Option<u32>,
}

impl ModelNmse {
    /// The error on data that the fit has not seen: of frames held out if there are any, else of
    /// blocks of cells.
    #[must_use]
    pub fn held_out(&self) -> Option<HeldOutError> {
        self.held_out_frames.or(self.cross_validated)
    }
}

/// An error on data that the fit has not seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct HeldOutError {
    /// The normalised mean square error.
    pub value: f64,
    /// Its standard error over the folds.
    pub standard_error: f64,
    /// Number of folds.
    pub folds: usize,
}

/// The base model with a generic description of what it leaves unexplained. Not a mechanism: it
/// says how much any mechanism of that smoothness could explain.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DescriptionFit {
    /// Id of the description, for example `smooth_field`.
    pub effect: String,
    /// Number of coefficients that the data determine.
    pub dimension: f64,
    /// Normalised errors.
    pub nmse: ModelNmse,
    /// What measurement noise alone makes of the held-out error.
    pub noise_floor_nmse: f64,
    /// Penalised χ² over its degrees of freedom.
    pub chi_square_per_dof: f64,
}
