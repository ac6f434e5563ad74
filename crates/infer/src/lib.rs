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

mod coefficients;
mod cross_validation;
mod degrees_of_freedom;
mod error;
mod estimates;
mod fit;
mod inference;
mod least_squares;
mod levenberg_marquardt;
mod linearisation;
mod noise;
mod objective;
mod observation;
pub mod quadratic;
mod result;
mod scale;

pub use coefficients::{CoefficientSpace, Fixed};
pub use error::Error;
pub use inference::infer;
pub use levenberg_marquardt::Progress;
pub use noise::{NoiseLevels, NoiseSource};
pub use observation::Observation;
pub use result::{Direction, Estimate, FrameResult, Inference, Nmse, ParameterEstimates, Request, Status};
pub use scale::Scale;
