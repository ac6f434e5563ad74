//! Between the units of the data and the scales of the tissue.

use nalgebra::Vector4;

/// The scales in which a fit is made: lengths in ℓ₀ (ℓ₀² = mean cell area), times in τ, so that velocities are of order one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// ℓ₀ in the data's unit of length.
    pub length: f64,
    /// τ in the data's unit of time.
    pub time: f64,
}

impl Scale {
    /// Velocities of the data per scaled velocity.
    pub fn velocity(&self) -> f64 {
        self.length / self.time
    }

    /// Factors from scaled coefficients `(K_A, K_P P_0, K_P, K_P α)` to those in the units of the data.
    pub fn coefficients(&self) -> Vector4<f64> {
        Vector4::new(1.0 / (self.length * self.length), self.length, 1.0, 1.0) / self.time
    }
}
