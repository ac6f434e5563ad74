//! The velocities to be explained.

use super::arguments::SnapshotArguments;
use super::flow::OrderedField;
use crate::failure::Failure;
use crate::snapshot::Snapshot;
use ndarray::{Array3, Axis};
use std::path::PathBuf;
use voronudge_infer::Velocities;
use voronudge_io::{DataSet, Difference, derive_velocities};

/// The velocities to be explained.
#[derive(Clone)]
pub(crate) enum Measured {
    /// Of cells, as given.
    Given(Array3<f64>),
    /// Of cells, from their tracks.
    Derived(Array3<f64>, Difference),
    /// None: the tracks themselves are to be explained. Mean velocities up to the next frame tell their scale.
    Tracks(Array3<f64>),
    /// On a grid.
    Flow(OrderedField),
}

impl Measured {
    /// Whether there are velocities of single cells.
    pub fn are_of_cells(&self) -> bool {
        matches!(self, Self::Given(_) | Self::Derived(..))
    }

    /// What there is to be explained: velocities if there are any, otherwise the tracks, or their differences if these are asked for.
    pub fn of_tracks(
        arguments: &SnapshotArguments,
        data: &DataSet,
        difference: Option<Difference>,
    ) -> Result<Self, Failure> {
        let on_grid = arguments.flow.field(&arguments.data, data)?.is_some();
        let measured = Self::new(arguments, data, difference.unwrap_or(Difference::Forward));
        match (difference, measured) {
            (None, Ok(Self::Derived(means, _))) => Ok(Self::Tracks(means)),
            (None, Err(_)) if !on_grid && data.velocities.is_none() && data.frames() < 2 => Err(Failure::new(
                "there is one frame and no velocities: nothing tells how cells move",
            )
            .with_hint(
                "give velocities, a flow field, or the positions of the same cells in two frames or more",
            )
            .at(arguments.data.positions_file().display())),
            (_, measured) => measured,
        }
    }

    /// The velocities that were asked for.
    pub fn new(
        arguments: &SnapshotArguments,
        data: &DataSet,
        difference: Difference,
    ) -> Result<Self, Failure> {
        if let Some(field) = arguments.flow.field(&arguments.data, data)? {
            return Ok(Self::Flow(field));
        }
        match &data.velocities {
            Some(given) => Ok(Self::Given(given.clone())),
            None => derive_velocities(data, difference)
                .map(|derived| Self::Derived(derived, difference))
                .map_err(|error| Failure::from(error).at(arguments.data.positions_file().display())),
        }
    }

    /// How velocities of cells were derived, if they were.
    pub fn derived(&self) -> Option<Difference> {
        match self {
            Self::Derived(_, difference) => Some(*difference),
            _ => None,
        }
    }

    /// The flow field, if velocities are on a grid.
    pub fn flow(&self) -> Option<&OrderedField> {
        match self {
            Self::Flow(field) => Some(field),
            _ => None,
        }
    }

    /// The same, to change it.
    pub fn flow_mut(&mut self) -> Option<&mut OrderedField> {
        match self {
            Self::Flow(field) => Some(field),
            _ => None,
        }
    }

    /// The file that holds them.
    pub fn file(&self, arguments: &SnapshotArguments) -> PathBuf {
        match self {
            Self::Given(_) => arguments.data.velocities_file(),
            Self::Derived(..) | Self::Tracks(_) => arguments.data.positions_file(),
            Self::Flow(_) => arguments.data.flow_file(),
        }
    }

    /// Lets a cell of a frame have no velocity that was derived from its track.
    pub fn forget(&mut self, frame: usize, cell: usize) {
        if let Self::Derived(all, _) | Self::Tracks(all) = self {
            (0..2).for_each(|axis| all[[frame, cell, axis]] = f64::NAN);
        }
    }

    /// Whether a frame has a velocity anywhere.
    pub fn has_velocity(&self, frame: usize) -> bool {
        match self {
            Self::Given(all) | Self::Derived(all, _) | Self::Tracks(all) => {
                all.index_axis(Axis(0), frame).iter().any(|v| v.is_finite())
            }
            Self::Flow(field) => field.has_velocity(frame),
        }
    }

    /// Those of one frame.
    pub fn of(&self, snapshot: &Snapshot, frame: usize) -> Velocities {
        match self {
            Self::Given(all) | Self::Derived(all, _) | Self::Tracks(all) => {
                snapshot.pick(all.index_axis(Axis(0), frame)).into()
            }
            Self::Flow(field) => Velocities::OnGrid(field.frame(frame)),
        }
    }

    /// The frames asked for; all that have velocities, if none were.
    pub fn frames(&self, arguments: &SnapshotArguments, data: &DataSet) -> Result<Vec<usize>, Failure> {
        if let Self::Tracks(_) = self {
            return track_frames(arguments, data);
        }
        let Some(selection) = &arguments.frames else {
            return Ok((0..data.frames()).filter(|&frame| self.has_velocity(frame)).collect());
        };
        let file = arguments.data.positions_file();
        let frames =
            selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(file.display()))?;
        if let Some(frame) = frames.iter().find(|&&frame| !self.has_velocity(frame)) {
            let (what, hint) = match self {
                Self::Derived(_, Difference::Central) => (
                    "no cell has a velocity",
                    "central differences need the frame before and the frame after",
                ),
                Self::Derived(..) | Self::Tracks(_) => {
                    ("no cell has a velocity", "differences need the neighbouring frame")
                }
                Self::Given(_) => {
                    ("no cell has a velocity", "choose a frame whose velocities are not all NaN")
                }
                Self::Flow(_) => ("no grid point has a velocity", "choose a frame whose flow is not all NaN"),
            };
            let place = format!("{}, frame {frame}", self.file(arguments).display());
            return Err(Failure::new(what).with_hint(hint).at(place));
        }
        Ok(frames)
    }
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
