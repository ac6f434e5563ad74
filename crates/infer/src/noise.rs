//! Errors of the measured positions and velocities.

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

/// Sums of squares of a fit and what they are expected to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spent {
    /// Σ ‖v − F‖² and the number of velocity components.
    pub residual: f64,
    pub components: f64,
    /// Σ ‖ε‖² and the degrees of freedom it uses.
    pub nudges: f64,
    pub degrees_of_freedom: f64,
    /// Number of fitted coefficients.
    pub free: f64,
}

impl Spent {
    /// The noise levels for which the sums of squares would be as expected: `σ_v² = Σ‖v − F‖² / (n − df − p)` and
    /// `σ_r² = Σ‖ε‖² / df`. Repeated with refits, this is the fixed point of restricted maximum likelihood.
    pub fn update(&self, levels: &NoiseLevels) -> NoiseLevels {
        let left = (self.components - self.degrees_of_freedom - self.free).max(1.0);
        // One round changes a level by no more than a factor of three: far from the solution the linearisation behind
        // the degrees of freedom is not worth more.
        let limited = |new: f64, old: f64| new.clamp(old / 3.0, old * 3.0);
        NoiseLevels {
            position: limited((self.nudges / self.degrees_of_freedom.max(1e-9)).sqrt(), levels.position)
                .clamp(SMALLEST_POSITION_NOISE, LARGEST_POSITION_NOISE),
            velocity: limited((self.residual / left).sqrt(), levels.velocity).max(SMALLEST_VELOCITY_NOISE),
        }
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
