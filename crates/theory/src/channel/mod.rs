//! Flow across and along a channel in which cells are extruded and born: one dimension of the paper's continuum theory.

mod evolution;
mod medium;

pub use evolution::ChannelEvolution;
pub use medium::ChannelMedium;

use crate::Error;

/// Turnover in a channel of width `W`, as functions of the distance `d` from the nearer edge:
///
/// ```text
/// k_extr = k₀ exp(−d/d_extr)        k_prolif = k₁ exp(−d/d_prolif)
/// ```
///
/// with `k₁` such that as many cells are born as are extruded (Methods, "Numerical simulation with proliferation and extrusion").
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelTurnover {
    /// Width `W` of the channel.
    pub width: f64,
    /// Rate of extrusion at the edge `k₀`.
    pub extrusion_rate: f64,
    /// Its decay length `d_extr`.
    pub extrusion_length: f64,
    /// Decay length of proliferation `d_prolif`.
    pub proliferation_length: f64,
}

impl ChannelTurnover {
    /// The same, if the lengths are positive and finite and the rate is not negative.
    ///
    /// # Errors
    /// [`Error::Channel`] otherwise.
    pub fn checked(self) -> Result<Self, Error> {
        let positive = [
            ("width of the channel", self.width),
            ("decay length of extrusion", self.extrusion_length),
            ("decay length of proliferation", self.proliferation_length),
        ];
        if let Some((name, value)) =
            positive.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0))
        {
            return Err(Error::Channel { name, value });
        }
        let rate = self.extrusion_rate;
        if !(rate.is_finite() && rate >= 0.0) {
            return Err(Error::Channel { name: "rate of extrusion", value: rate });
        }
        Ok(self)
    }

    /// The velocity `v_x` towards the middle at a distance `d ≤ W/2` from the edge, in the steady state and to first order in
    /// the differences of density:
    ///
    /// ```text
    /// v_x = ∫_0^d (k_prolif − k_extr) dx = k₀ d_extr [ E_extr E_prolif(d)/E_prolif(W/2) − E_extr(d) ],   E_j(d) = 1 − exp(−d/d_j)
    /// ```
    ///
    /// with `E_extr = E_extr(W/2)`. It follows from the conservation of cells alone and contains no property of the tissue.
    ///
    /// ```
    /// use voronudge_theory::ChannelTurnover;
    /// let turnover = ChannelTurnover {
    ///     width: 20.0, extrusion_rate: 0.77, extrusion_length: 1.4, proliferation_length: 0.25,
    /// };
    /// assert!(turnover.velocity(10.0).abs() < 1e-15 && turnover.velocity(0.0) == 0.0);
    /// assert!((turnover.velocity(3.0) - 0.77 * 1.4 * (-3.0f64 / 1.4).exp()).abs() < 2e-3); // far from both
    /// ```
    pub fn velocity(&self, distance: f64) -> f64 {
        let share = |length: f64, d: f64| -(-d / length).exp_m1();
        let middle = 0.5 * self.width;
        let born = share(self.proliferation_length, distance) / share(self.proliferation_length, middle);
        let all = share(self.extrusion_length, middle);
        self.extrusion_rate * self.extrusion_length * (all * born - share(self.extrusion_length, distance))
    }
}
