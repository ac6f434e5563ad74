//! The two axes of the plane.

use std::fmt;

/// One of the two coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axis {
    /// To the right.
    #[default]
    X,
    /// Up.
    Y,
}

impl Axis {
    /// Both axes in order.
    pub const BOTH: [Self; 2] = [Self::X, Self::Y];

    /// 0 for x, 1 for y.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::X => "x",
            Self::Y => "y",
        })
    }
}
