//! What tells how the cells move.

use super::{Error, OrderedField};
use ndarray::{Array3, Axis};
use voronudge_geometry::FieldOfView;
use voronudge_infer::{KnownMeasurement, Observation, Scale, Velocities};
use voronudge_io::{DataSet, DeclaredWindow, Difference, FlowField, Snapshot, derive_velocities};

/// What tells how the cells move, in the units of the data: velocities of cells as arrays (frames, cells, 2) over all frames of the data set,
/// NaN where there is none, or a field on a grid.
#[derive(Debug, Clone)]
pub enum Measured {
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
    /// What there is to be explained: given velocities of cells, or a flow field where there are none; otherwise the tracks, or their
    /// differences if these are asked for.
    ///
    /// # Errors
    /// [`Error::NothingTellsMotion`], [`Error::Data`] if there are too few frames for differences, [`Error::Geometry`] for a grid that is none.
    pub fn of(data: &DataSet, difference: Option<Difference>) -> Result<Self, Error> {
        match &data.flow {
            Some(field) if data.velocities.is_none() => Self::on_grid(field, data.window),
            _ => Self::tracks_or_cells(data, difference),
        }
    }

    /// The same without regard to a flow field.
    ///
    /// # Errors
    /// [`Error::NothingTellsMotion`], [`Error::Data`] if there are too few frames for differences.
    pub fn tracks_or_cells(data: &DataSet, difference: Option<Difference>) -> Result<Self, Error> {
        if difference.is_none() && data.velocities.is_none() && data.frames() < 2 {
            return Err(Error::NothingTellsMotion);
        }
        let measured = Self::of_cells(data, difference.unwrap_or(Difference::Forward))?;
        Ok(match (difference, measured) {
            (None, Self::Derived(means, _)) => Self::Tracks(means),
            (_, measured) => measured,
        })
    }

    /// Velocities of cells: given ones, or differences of their positions where there are none.
    ///
    /// # Errors
    /// Those of [`derive_velocities`].
    pub fn of_cells(data: &DataSet, difference: Difference) -> Result<Self, voronudge_io::Error> {
        match &data.velocities {
            Some(given) => Ok(Self::Given(given.clone())),
            None => Ok(Self::Derived(derive_velocities(data, difference)?, difference)),
        }
    }

    /// Velocities on a grid, with what is declared of its points.
    ///
    /// # Errors
    /// [`Error::Geometry`] for a grid that is none.
    pub fn on_grid(field: &FlowField, window: DeclaredWindow) -> Result<Self, Error> {
        Ok(Self::Flow(OrderedField::new(field, window)?))
    }

    /// Whether there are velocities of single cells.
    pub fn are_of_cells(&self) -> bool {
        matches!(self, Self::Given(_) | Self::Derived(..))
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
    pub(super) fn flow_mut(&mut self) -> Option<&mut OrderedField> {
        match self {
            Self::Flow(field) => Some(field),
            _ => None,
        }
    }

    /// Velocities of cells, or mean velocities along their tracks, (frames, cells, 2).
    fn of_all_cells(&self) -> Option<&Array3<f64>> {
        match self {
            Self::Given(all) | Self::Derived(all, _) | Self::Tracks(all) => Some(all),
            Self::Flow(_) => None,
        }
    }

    /// Lets a cell of a frame have no velocity that was derived from its track.
    pub(super) fn forget(&mut self, frame: usize, cell: usize) {
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

    /// The frames that can be explained: all that have velocities; of tracks all.
    pub fn frames(&self) -> Vec<usize> {
        let all = match self {
            Self::Flow(field) => field.frames(),
            Self::Given(all) | Self::Derived(all, _) | Self::Tracks(all) => all.dim().0,
        };
        let tracks = matches!(self, Self::Tracks(_));
        (0..all).filter(|&frame| tracks || self.has_velocity(frame)).collect()
    }

    /// The cells of one frame with their velocities, in the units of the data. `largest_area` is that of the [`Question`](super::Question).
    ///
    /// # Errors
    /// [`Error::Frame`], [`Error::Data`] for a boundary that does not stay the same or has walls, [`Error::Geometry`] for a field of view that
    /// is none.
    pub fn observe(
        &self,
        data: &DataSet,
        largest_area: f64,
        frame: usize,
    ) -> Result<(Snapshot, Observation), Error> {
        let snapshot = Snapshot::new(data, frame);
        let velocities = match self.of_all_cells() {
            Some(all) => Velocities::OfCells(snapshot.pick(all.index_axis(Axis(0), frame))),
            None => {
                self.flow().map_or_else(|| Vec::new().into(), |field| Velocities::OnGrid(field.frame(frame)))
            }
        };
        let view = FieldOfView { largest_area, ..data.view()? };
        let observed = Observation::new(frame, snapshot.positions.clone(), velocities, data.domain()?, view);
        let observation = observed.map_err(|error| match error {
            voronudge_infer::Error::Geometry { source, .. } => {
                Error::Frame { frame, source: snapshot.in_file_numbers(source) }
            }
            other => other.into(),
        })?;
        Ok((snapshot, observation))
    }

    /// What is declared of the measurement, in the units of the fit.
    pub(super) fn known(&self, data: &DataSet, scale: &Scale) -> KnownMeasurement {
        let declared = self.flow().map(OrderedField::declared).unwrap_or_default();
        KnownMeasurement {
            share: data.positions_are.map(|are| are.share()),
            kind: declared.kind.map(super::field::kind),
            width: declared.width.map(|width| width / scale.length),
        }
    }
}

/// The median of errors: those of a few cells, at the border of an image for one, may be far larger.
pub(super) fn typical<'a>(errors: impl Iterator<Item = &'a f64>) -> Option<f64> {
    let mut errors: Vec<f64> = errors.copied().collect();
    let middle = errors.len() / 2;
    (middle < errors.len()).then(|| *errors.select_nth_unstable_by(middle, f64::total_cmp).1)
}
