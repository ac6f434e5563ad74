//! How the velocities are integrated from one instant to the next.
//!
//! ```text
//! trapezoid         ∫F ≈ h/2 (F_0 + F_1)
//! Hermite–Simpson   ∫F ≈ h/6 (F_0 + 4 F_½ + F_1),    F_½ = F(x_½),    x_½ = (x_0 + x_1)/2 + h/8 (F_0 − F_1)
//! ```
//!
//! The second is exact to fourth order in h where the first is to second (C. R. Hargraves and S. W. Paris, *J. Guidance* 10, 338 (1987)):
//! the place in the middle is that of the cubic with the right places and velocities at both ends, so it is no further unknown.

/// A rule of integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scheme {
    /// The mean of the velocities at both ends.
    Trapezoid,
    /// Simpson's rule with a middle on the cubic through both ends.
    HermiteSimpson,
}

/// A rule and the instants that it goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rule {
    pub scheme: Scheme,
    /// Steps from one frame to the next, all of one length.
    pub steps: usize,
}

impl Rule {
    /// The mean of the velocities at two frames.
    pub const TRAPEZOID: Self = Self { scheme: Scheme::Trapezoid, steps: 1 };

    /// From coarse to fine.
    pub const LADDER: [Self; 5] = [
        Self::TRAPEZOID,
        Self { scheme: Scheme::HermiteSimpson, steps: 1 },
        Self { scheme: Scheme::HermiteSimpson, steps: 2 },
        Self { scheme: Scheme::HermiteSimpson, steps: 4 },
        Self { scheme: Scheme::HermiteSimpson, steps: 8 },
    ];

    /// Order in the length of a step to which the integral is exact.
    pub fn order(self) -> usize {
        match self.scheme {
            Scheme::Trapezoid => 2,
            Scheme::HermiteSimpson => 4,
        }
    }

    /// Weights of the velocities at the ends of a step and in its middle.
    pub fn weights(self) -> ([f64; 2], f64) {
        match self.scheme {
            Scheme::Trapezoid => ([0.5; 2], 0.0),
            Scheme::HermiteSimpson => ([1.0 / 6.0; 2], 2.0 / 3.0),
        }
    }
}
