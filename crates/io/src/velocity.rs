//! Velocities from tracked positions.

use std::str::FromStr;

use ndarray::Array3;

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::difference::Difference;
use crate::error::{Error, SettingFault};

/// Velocities from tracked positions, (frames, cells, 2), in `length_unit` per `time_unit`.
///
/// NaN where the cell is absent in the frame itself or in a neighbouring frame that the
/// difference needs, hence in the whole first and last frame for central differences.
///
/// In a periodic box each step between frames is taken as the shortest one among the images, so
/// a step must stay below half the box; a central difference adds two such steps. Positions
/// marked `unwrapped` are taken as they are.
///
/// # Errors
/// [`Error::TooFewFrames`] below three frames (central) or two (forward, backward).
pub fn derive_velocities(data: &DataSet, difference: Difference) -> Result<Array3<f64>, Error> {
    let (frames, cells, _) = data.positions.dim();
    let needed = difference.frames_needed();
    if frames < needed {
        return Err(Error::TooFewFrames { difference, needed, found: frames });
    }
    let positions = &data.positions;
    let step = |from: usize, to: usize, cell: usize, axis: usize| {
        let raw = positions[[to, cell, axis]] - positions[[from, cell, axis]];
        match data.boundary {
            Boundary::Periodic { lengths } if !data.unwrapped => shortest(raw, lengths[axis]),
            _ => raw,
        }
    };
    let interval = data.frame_interval;
    Ok(Array3::from_shape_fn((frames, cells, 2), |(frame, cell, axis)| {
        let before = frame.checked_sub(1);
        let after = Some(frame + 1).filter(|&next| next < frames);
        match (difference, before, after) {
            // Going through the present frame makes a cell absent there NaN by itself.
            (Difference::Central, Some(before), Some(after)) => {
                let path = step(before, frame, cell, axis) + step(frame, after, cell, axis);
                path / (2.0 * interval)
            }
            (Difference::Forward, _, Some(after)) => step(frame, after, cell, axis) / interval,
            (Difference::Backward, Some(before), _) => step(before, frame, cell, axis) / interval,
            _ => f64::NAN,
        }
    }))
}

/// The image of a displacement nearest to zero.
fn shortest(displacement: f64, length: f64) -> f64 {
    displacement - length * (displacement / length).round()
}

impl FromStr for Difference {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        match text {
            "central" => Ok(Self::Central),
            "forward" => Ok(Self::Forward),
            "backward" => Ok(Self::Backward),
            _ => Err(Error::Setting(SettingFault::Unknown {
                key: "difference",
                found: text.to_owned(),
                expected: "\"central\", \"forward\" or \"backward\"",
            })),
        }
    }
}
