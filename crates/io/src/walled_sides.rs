//! Walls at sides of a periodic box.

use std::fmt;

/// Sides of a periodic box that are walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalledSides {
    /// The left and the right one: a channel.
    X,
    /// All four.
    Both,
}

impl fmt::Display for WalledSides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Both => "both",
        })
    }
}
