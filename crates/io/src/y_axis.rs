//! The direction of the y coordinate in files.

use std::fmt;
use std::str::FromStr;

use ndarray::{Array, Axis, RemoveAxis};

use crate::error::{Error, SettingFault};

/// The direction of the stored y coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum YAxis {
    /// Larger y is further up, as in mathematics.
    #[default]
    Up,
    /// Larger y is further down, as in images.
    Down,
}

impl YAxis {
    /// Turns offsets of the box of a file into those of y up or back: a mirror reverses the shear.
    pub(crate) fn turn_offsets(self, offsets: &mut [f64]) {
        if self == Self::Down {
            offsets.iter_mut().for_each(|offset| *offset = 0.0 - *offset);
        }
    }

    /// Turns stored vectors into y-up vectors or back; the two directions are the same.
    ///
    /// The last axis holds x, y.
    pub(crate) fn turn<D: RemoveAxis>(self, vectors: &mut Array<f64, D>) {
        if self == Self::Down {
            let last = Axis(vectors.ndim() - 1);
            // 0 − y rather than −y, so that no negative zero appears.
            let mut y = vectors.index_axis_mut(last, 1);
            y.mapv_inplace(|value| 0.0 - value);
        }
    }

    pub(crate) fn parse(text: &str) -> Result<Self, SettingFault> {
        match text {
            "up" => Ok(Self::Up),
            "down" => Ok(Self::Down),
            _ => Err(SettingFault::Unknown {
                key: "y_axis",
                found: text.to_owned(),
                expected: "\"up\" or \"down\"",
            }),
        }
    }
}

impl FromStr for YAxis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text).map_err(Error::Setting)
    }
}

impl fmt::Display for YAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Up => "up",
            Self::Down => "down",
        })
    }
}
