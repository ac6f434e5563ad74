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
pub(crate) enum Measured {
    /// Of cells, as given.
    Given(Array3<f64>),
    /// Of cells, from their tracks.
    Derived(Array3<f64>, Difference),
    /// On a grid.
    Flow(OrderedField),
}

impl Measured {
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

    /// The file that holds them.
    pub fn file(&self, arguments: &SnapshotArguments) -> PathBuf {
        match self {
            Self::Given(_) => arguments.data.velocities_file(),
            Self::Derived(..) => arguments.data.positions_file(),
            Self::Flow(_) => arguments.data.flow_file(),
        }
    }

    /// Whether a frame has a velocity anywhere.
    pub fn has_velocity(&self, frame: usize) -> bool {
        match self {
            Self::Given(all) | Self::Derived(all, _) => {
                all.index_axis(Axis(0), frame).iter().any(|v| v.is_finite())
            }
            Self::Flow(field) => field.has_velocity(frame),
        }
    }

    /// Those of one frame.
    pub fn of(&self, snapshot: &Snapshot, frame: usize) -> Velocities {
        match self {
            Self::Given(all) | Self::Derived(all, _) => snapshot.pick(all.index_axis(Axis(0), frame)).into(),
            Self::Flow(field) => Velocities::OnGrid(field.frame(frame)),
        }
    }

    /// The frames asked for; all that have velocities, if none were.
    pub fn frames(&self, arguments: &SnapshotArguments, data: &DataSet) -> Result<Vec<usize>, Failure> {
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
                Self::Derived(..) => ("no cell has a velocity", "differences need the neighbouring frame"),
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
