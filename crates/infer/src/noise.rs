//! Errors of the measured positions and velocities.

use crate::Error;

/// Where noise levels come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseSource {
    /// Both were given.
    Given,
    /// At least one was estimated from the fit itself.
    Estimated,
}

/// Standard deviations of one component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevels {
    /// σ_r: error of a coordinate.
    pub position: f64,
    /// σ_v: error of a velocity component.
    pub velocity: f64,
}

impl NoiseLevels {
    /// The spring constant `k = σ_v² / σ_r²` that makes nudging generalised least squares.
    pub fn spring(&self) -> f64 {
        (self.velocity / self.position).powi(2)
    }
}

/// Noise levels as given beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KnownNoise {
    /// σ_r, if known.
    pub position: Option<f64>,
    /// σ_v, if known.
    pub velocity: Option<f64>,
}

impl KnownNoise {
    /// Whether nothing is left to estimate.
    pub(crate) fn source(&self) -> NoiseSource {
        match (self.position, self.velocity) {
            (Some(_), Some(_)) => NoiseSource::Given,
            _ => NoiseSource::Estimated,
        }
    }

    /// σ_v² where it follows from k and what is known.
    pub(crate) fn variance(&self, log_k: f64) -> Option<f64> {
        match (self.velocity, self.position) {
            (Some(velocity), _) => Some(velocity * velocity),
            (None, Some(position)) => Some(position * position * log_k.exp()),
            (None, None) => None,
        }
    }

    /// Refuses levels that are none.
    pub(crate) fn check(&self) -> Result<(), Error> {
        for (name, value) in [("position", self.position), ("velocity", self.velocity)] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(Error::Noise { name, value });
            }
        }
        Ok(())
    }
}

/// Position noise assumed first, in units of ℓ₀: a careful segmentation.
pub(crate) const FIRST_POSITION_NOISE: f64 = 0.02;

/// Estimates of the position noise stay between these, in units of ℓ₀: below, nudges have no effect; above, cells have
/// no place.
pub(crate) const SMALLEST_POSITION_NOISE: f64 = 1e-3;
pub(crate) const LARGEST_POSITION_NOISE: f64 = 0.15;

/// Estimates of the velocity noise stay above this, in units of the velocities: with softer springs the nudges could
/// explain anything.
pub(crate) const SMALLEST_VELOCITY_NOISE: f64 = 1e-3;
