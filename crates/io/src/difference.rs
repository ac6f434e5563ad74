//! Kinds of differences of positions.

use std::fmt;

/// How a velocity is made from positions r(t) at frame interval Δt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Difference {
    /// (r(t+1) − r(t−1)) / 2Δt. Does not share localisation noise with r(t).
    #[default]
    Central,
    /// (r(t+1) − r(t)) / Δt. Noise in r(t) looks like a restoring force.
    Forward,
    /// (r(t) − r(t−1)) / Δt. Noise in r(t) looks like a repelling force.
    Backward,
}

impl Difference {
    /// Frames that a data set must have.
    #[must_use]
    pub fn frames_needed(self) -> usize {
        match self {
            Self::Central => 3,
            Self::Forward | Self::Backward => 2,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Central => "central",
            Self::Forward => "forward",
            Self::Backward => "backward",
        })
    }
}
