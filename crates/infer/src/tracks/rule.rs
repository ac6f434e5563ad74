//! How the velocities are integrated from one frame to the next.
//!
//! ```text
//! trapezoid      x_{f+1} − x_f = T/2 (F(x_f) + F(x_{f+1}))
//! Runge–Kutta    from x_f on in m steps of T/m
//! ```
//!
//! The first takes one step whatever happens between; the second follows the cells through changes of neighbours in as many steps as it
//! takes ([`super::passage`]).

/// A rule of integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The mean of the velocities at both frames.
    Trapezoid,
    /// The method of fourth order from the first frame on, in so many steps.
    RungeKutta(usize),
}

impl Rule {
    /// Order in the length of a step to which the motion from one frame to the next is exact.
    pub fn order(self) -> usize {
        match self {
            Self::Trapezoid => 2,
            Self::RungeKutta(_) => 4,
        }
    }

    /// Steps from one frame to the next.
    pub fn steps(self) -> usize {
        match self {
            Self::Trapezoid => 1,
            Self::RungeKutta(steps) => steps,
        }
    }

    /// The same for half the time.
    pub fn half(self) -> Self {
        match self {
            Self::Trapezoid => self,
            Self::RungeKutta(steps) => Self::RungeKutta(steps.div_ceil(2)),
        }
    }

    /// The same with twice the steps.
    pub fn twice(self) -> Self {
        Self::RungeKutta(2 * self.steps())
    }
}
