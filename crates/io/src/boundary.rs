//! What is around the cells.

use crate::error::SettingFault;
use crate::positive::positive;

/// What is around the cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// A rectangular box that repeats.
    Periodic {
        /// Box lengths along x and y in the unit of length.
        lengths: [f64; 2],
    },
    /// A field of view whose surroundings are not seen.
    Open,
}

impl Boundary {
    pub(crate) fn check(&self) -> Result<(), SettingFault> {
        match self {
            Self::Open => Ok(()),
            Self::Periodic { lengths } => {
                lengths.iter().try_for_each(|&length| positive("box length", length))
            }
        }
    }
}
