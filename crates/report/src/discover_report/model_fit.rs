//! One fitted model: parameters, errors, noise, nudges.

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::{EigenDirection, Fit, MeanRemoved, Noise, Nudge, Parameters};

/// One fitted model, either the base model or the model with the effects, as `infer` reports it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModelFit {
    /// Nudged estimate of the parameters.
    pub parameters: Parameters,
    /// Normalised mean square errors.
    pub nmse: ModelNmse,
    /// What `nmse.un_nudged` and the held-out error would be from measurement noise alone, if the model is right; `null` where positions are not those of
    /// sites.
    pub noise_floor_nmse: f64,
    /// Measurement noise; if it is estimated, an upper bound as long as the model lacks something.
    pub noise: Noise,
    /// The nudges: fitted displacements of the measured positions.
    pub nudge: Nudge,
    /// Principal axes of the covariance of all coefficients, best determined first.
    pub identifiability: Vec<EigenDirection>,
    /// Penalised χ² over its degrees of freedom, which is one if the model and the noise levels are right.
    pub chi_square_per_dof: f64,
    /// How the fit proceeded and ended; `null` where it is not kept.
    pub fit: Option<Fit>,
}

/// Normalised mean square errors Σ‖v − v̂‖²/Σ‖v‖² over the cells used.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModelNmse {
    /// Error of the parameters from least squares at the measured positions.
    pub naive: f64,
    /// Error of the nudged parameters at the nudged positions (the fit's own data). It falls with every effect, needed or not, and is no measure of success.
    pub nudged: f64,
    /// Error of the nudged parameters at the measured positions.
    pub un_nudged: f64,
    /// Error on blocks of cells predicted from fits that did not see their velocities; `null` if not computed.
    pub cross_validated: Option<HeldOutError>,
    /// Error on frames predicted from fits that did not see them; `null` if not computed.
    pub held_out_frames: Option<HeldOutError>,
    /// Which mean velocity was subtracted from the data.
    pub mean_removed: MeanRemoved,
    /// Degree of the background, polynomials of the position that the model need not explain; `null` without a background.
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
    /// Normalised mean square error.
    pub value: f64,
    /// Its standard error over the folds.
    pub standard_error: f64,
    /// Number of folds.
    pub folds: usize,
}

/// The base model with a generic description of what it leaves unexplained. This is not a mechanism: it says how much any mechanism of the same smoothness
/// could explain.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DescriptionFit {
    /// ID of the description, for example `smooth_field`.
    pub effect: String,
    /// Number of coefficients that the data determine.
    pub dimension: f64,
    /// Normalised mean square errors.
    pub nmse: ModelNmse,
    /// What the held-out error would be from measurement noise alone.
    pub noise_floor_nmse: f64,
    /// Penalised χ² over its degrees of freedom.
    pub chi_square_per_dof: f64,
}
