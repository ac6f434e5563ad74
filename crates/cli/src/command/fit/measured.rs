//! The velocities to be explained, and in which frames.

use super::arguments::SnapshotArguments;
use crate::failure::Failure;
use crate::problem::{Error, Measured};
use std::path::PathBuf;
use voronudge_io::{DataSet, Difference};

/// What there is to be explained: velocities if there are any, otherwise the tracks, or their differences if these are asked for.
pub(crate) fn measured(
    arguments: &SnapshotArguments,
    data: &DataSet,
    difference: Option<Difference>,
) -> Result<Measured, Failure> {
    match arguments.flow.field(&arguments.data, data)? {
        Some(field) => Ok(Measured::Flow(field)),
        None => Measured::tracks_or_cells(data, difference).map_err(|error| faulty(error, arguments)),
    }
}

/// The velocities that were asked for.
pub(crate) fn velocities(
    arguments: &SnapshotArguments,
    data: &DataSet,
    difference: Difference,
) -> Result<Measured, Failure> {
    match arguments.flow.field(&arguments.data, data)? {
        Some(field) => Ok(Measured::Flow(field)),
        None => Measured::of_cells(data, difference).map_err(|error| faulty(error.into(), arguments)),
    }
}

fn faulty(error: Error, arguments: &SnapshotArguments) -> Failure {
    Failure::from(error).at(arguments.data.positions_file().display())
}

/// The file that holds velocities.
pub(super) fn file(measured: &Measured, arguments: &SnapshotArguments) -> PathBuf {
    match measured {
        Measured::Given(_) => arguments.data.velocities_file(),
        Measured::Derived(..) | Measured::Tracks(_) => arguments.data.positions_file(),
        Measured::Flow(_) => arguments.data.flow_file(),
    }
}

/// The frames asked for; all that have velocities, if none were.
pub(crate) fn frames(
    measured: &Measured,
    arguments: &SnapshotArguments,
    data: &DataSet,
) -> Result<Vec<usize>, Failure> {
    if let Measured::Tracks(_) = measured {
        return track_frames(arguments, data);
    }
    let Some(selection) = &arguments.frames else {
        return Ok(measured.frames());
    };
    let positions = arguments.data.positions_file();
    let frames =
        selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(positions.display()))?;
    if let Some(frame) = frames.iter().find(|&&frame| !measured.has_velocity(frame)) {
        let (what, hint) = match measured {
            Measured::Derived(_, Difference::Central) => {
                ("no cell has a velocity", "central differences need the frame before and the frame after")
            }
            Measured::Derived(..) | Measured::Tracks(_) => {
                ("no cell has a velocity", "differences need the neighbouring frame")
            }
            Measured::Given(_) => {
                ("no cell has a velocity", "choose a frame whose velocities are not all NaN")
            }
            Measured::Flow(_) => ("no grid point has a velocity", "choose a frame whose flow is not all NaN"),
        };
        let place = format!("{}, frame {frame}", file(measured, arguments).display());
        return Err(Failure::new(what).with_hint(hint).at(place));
    }
    Ok(frames)
}

/// The frames whose tracks are to be explained: those asked for, or all.
fn track_frames(arguments: &SnapshotArguments, data: &DataSet) -> Result<Vec<usize>, Failure> {
    let file = arguments.data.positions_file();
    let mut frames: Vec<usize> = match &arguments.frames {
        None => (0..data.frames()).collect(),
        Some(selection) => {
            selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(file.display()))?
        }
    };
    frames.sort_unstable();
    match frames.as_slice() {
        [only] => Err(Failure::new("tracks take two frames or more")
            .with_hint("add the frames before and after, or give --difference central for a velocity of this frame alone")
            .at(format!("{}, frame {only}", file.display()))),
        _ => Ok(frames),
    }
}
