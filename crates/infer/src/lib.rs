//! Nudged inference (NADA): the parameters of the model and small displacements of the cells, fitted together to
//! measured velocities.
//!
//! ```text
//! minimise over θ, ε:   Σ ‖v − F_θ(r + ε)‖² / σ_v²  +  Σ ‖ε‖² / σ_r²,        k = σ_v² / σ_r²
//! ```
//!
//! The springs of strength k keep the nudges ε within the error of the positions. Velocities are linear in the
//! coefficients of the model's terms; the nudges are not linear and change who is a neighbour of whom, so the
//! tessellation is renewed at every trial.
//!
//! Everything here is dimensionless or in the units of what is passed in.

mod background;
mod coefficients;
mod constraints;
mod cross_validation;
mod curvature;
mod curve;
pub mod diagnostics;
pub mod discover;
mod doubts;
mod error;
mod estimates;
mod excerpt;
mod fit_parameter;
mod flow;
pub mod forecast;
mod free_cells;
mod gram;
mod inference;
mod kinds;
mod latent;
mod least_squares;
mod levenberg_marquardt;
mod linearisation;
mod measurement;
mod median;
mod noise;
mod noisy_fit;
mod normal_equations;
mod normal_matrix;
mod objective;
mod observation;
mod obstacles;
mod own_parts;
pub mod phase_diffusion;
mod placing;
mod position_rows;
mod predictive;
mod prospects;
mod quadratic;
mod replicates;
mod request;
mod residuals;
mod restricted;
mod result;
mod robust;
mod rows;
#[cfg(test)]
mod sample;
mod scale;
mod search;
mod seeds;
mod sites;
mod spread;
mod stiffness;
#[cfg(test)]
mod tests;
mod tracks;
mod uncertainty;
mod unknown;
mod verdict;
mod whitened;
mod whitening;

pub use coefficients::CoefficientSpace;
pub use constraints::{Constraints, Prior};
pub use curve::{DecayFit, DecayPoint, DecayShape, Intercept, Line, LinePoint, fit_decay, straight_line};
pub use doubts::{Doubt, Part, Voids};
pub use error::Error;
pub use estimates::{COEFFICIENT_SIZES, NORMAL_95};
pub use fit_parameter::FitParameter;
pub use flow::{Flow, Window, WindowKind};
pub use inference::infer;
pub use kinds::{KindEstimates, Kinds};
pub use latent::{Change, ChangeKind, CompletedFrame, Completion, Origin, complete};
pub use levenberg_marquardt::Progress;
pub use measurement::{Determined, KnownMeasurement, Measurement, RivalWindow, measure};
pub use noise::{KnownNoise, NoiseLevels, NoiseSource};
pub use observation::{Observation, Velocities};
pub use prospects::{Ambiguity, Design, Prospect, Prospects, prospects};
pub use replicates::{Keeper, Known, Unkept};
pub use request::{Activity, CrossValidation, Drives, Examination, Loss, Method, Request};
pub use result::{Direction, Estimate, FrameResult, Inference, Nmse, ParameterEstimates, Status};
pub use scale::Scale;
pub use sites::{Outlined, Sites, sites};
pub use spread::Spread;
pub use tracks::{
    Alignment, Drift, Drive, Integration, Jump, Latent, Movie, Polarity, Sighting, Track, Tracked,
    complete_tracks, infer_tracks, measure_tracks,
};
pub use uncertainty::{Bootstrap, Landscape, Profile, bootstrap, landscape, profile};
pub use verdict::Verdict;
