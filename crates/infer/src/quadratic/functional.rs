//! Linear functions of the coefficients, and their ratios.

use super::HalfSpace;
use nalgebra::DVector;

/// `a₀ + aᵀβ`.
#[derive(Debug, Clone, PartialEq)]
pub struct Functional {
    /// `a₀`
    pub constant: f64,
    /// `a`
    pub gradient: DVector<f64>,
}

impl From<DVector<f64>> for Functional {
    fn from(gradient: DVector<f64>) -> Self {
        Self { constant: 0.0, gradient }
    }
}

impl Functional {
    /// `−a₀ − aᵀβ`
    pub fn negative(&self) -> Self {
        Self { constant: -self.constant, gradient: -&self.gradient }
    }

    /// Where it is not negative; `None` where that does not depend on β.
    pub fn positive(&self) -> Option<HalfSpace> {
        let half = HalfSpace { normal: self.gradient.clone(), bound: -self.constant };
        (self.gradient.amax() > 0.0).then_some(half)
    }
}

/// The ratio `(a₀ + aᵀβ) / (b₀ + bᵀβ)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// `a₀ + aᵀβ`
    pub numerator: Functional,
    /// `b₀ + bᵀβ`, not zero throughout.
    pub denominator: Functional,
    /// Whether `b₀ + bᵀβ ≥ 0` is known: a further constraint.
    pub positive_denominator: bool,
}
