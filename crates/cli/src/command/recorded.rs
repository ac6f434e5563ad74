//! A data set as a recording: what commands that measure have in common.

use crate::arguments::DataSetArguments;
use crate::boundary::domain_at;
use crate::command::fit::{MeanToRemove, check_largest_area};
use crate::failure::Failure;
use crate::memory::{OF_A_DESCRIBED_CELL, refuse_beyond};
use clap::Args;
use ndarray::{Array3, Axis};
use voronudge_geometry::{Domain, FieldOfView, Vector};
use voronudge_io::{DataSet, FrameSelection};
use voronudge_observables::{Error, Images, Recording};

#[derive(Debug, Args)]
pub(super) struct RecordingArguments {
    #[command(flatten)]
    pub data: DataSetArguments,
    /// Frames to measure, counted from zero: `6`, `4..16` (end excluded) or `4,7,9` [default: all].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    /// Mean motion to subtract first, because a drifting stage adds one.
    #[arg(long, value_enum, default_value_t = MeanToRemove::Auto)]
    remove_mean: MeanToRemove,
    /// In an open field of view, treat polygons larger than this multiple of the median area as holes in the data.
    #[arg(long, value_name = "FACTOR", default_value_t = 3.0, allow_negative_numbers = true)]
    largest_area: f64,
}

/// Where velocities come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Velocities {
    Given,
    FromPositions,
    None,
}

impl Velocities {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::FromPositions => "from_positions",
            Self::None => "none",
        }
    }
}

/// A recording and how it was made.
pub(super) struct Recorded {
    pub recording: Recording,
    pub velocities: Velocities,
    pub common_motion_removed: bool,
}

impl RecordingArguments {
    /// Refuses what makes no sense whatever the data.
    pub fn check(&self) -> Result<(), Failure> {
        check_largest_area(self.largest_area)
    }

    /// The file that faults are told of.
    pub fn location(&self) -> String {
        self.data.positions_file().display().to_string()
    }

    /// What the page is called.
    pub fn title(&self) -> String {
        self.data.dataset.as_ref().map_or_else(|| self.location(), |folder| folder.display().to_string())
    }

    /// The frames that are asked for, as many as the machine has memory for.
    pub fn frames(&self, data: &DataSet) -> Result<Vec<usize>, Failure> {
        let frames = match &self.frames {
            Some(selection) => {
                selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(self.location()))?
            }
            None => (0..data.frames()).collect(),
        };
        let (cells, count) = (data.cells(), frames.len());
        refuse_beyond(format!("{cells} cells in {count} frames"), cells * count, OF_A_DESCRIBED_CELL)?;
        Ok(frames)
    }

    /// The recording of these frames.
    pub fn record(&self, data: &DataSet, frames: &[usize]) -> Result<Recorded, Failure> {
        let place = self.location();
        let at = |error: Error| match error {
            Error::Tessellation { frame, source } => {
                Failure::from(source).at(format!("{place}, frame {}", frames[frame]))
            }
            other => Failure::from(other).at(&place),
        };
        let view = FieldOfView { largest_area: self.largest_area, ..data.view()? };
        let times: Vec<f64> = frames.iter().map(|frame| *frame as f64 * data.frame_interval).collect();
        let domains =
            frames.iter().map(|frame| domain_at(data, *frame)).collect::<Result<Vec<Domain>, Failure>>()?;
        let of_frame = |all: &Array3<f64>, frame: usize| -> Vec<Option<Vector<f64>>> {
            let rows = all.index_axis(Axis(0), frame);
            let vector = |v: ndarray::ArrayView1<'_, f64>| Vector::new(v[0], v[1]);
            rows.rows().into_iter().map(vector).map(|v| (v.x + v.y).is_finite().then_some(v)).collect()
        };
        let all = |array: &Array3<f64>| -> Vec<Vec<Option<Vector<f64>>>> {
            frames.iter().map(|frame| of_frame(array, *frame)).collect()
        };
        let images = if data.unwrapped { Images::Followed } else { Images::Nearest };
        let mut recording =
            Recording::new(&times, all(&data.positions), &domains, &view, images).map_err(at)?;
        let velocities = match &data.velocities {
            Some(given) => {
                recording = recording.with_velocities(&all(given)).map_err(at)?;
                Velocities::Given
            }
            None if frames.len() > 1 => Velocities::FromPositions,
            None => Velocities::None,
        };
        let common_motion_removed = match self.remove_mean {
            MeanToRemove::None => false,
            MeanToRemove::PerFrame => true,
            MeanToRemove::Auto => velocities == Velocities::FromPositions && domains.contains(&Domain::Open),
        };
        if common_motion_removed {
            recording = recording.without_common_motion();
        }
        if velocities == Velocities::FromPositions {
            recording = recording.with_mean_velocities();
        }
        Ok(Recorded { recording, velocities, common_motion_removed })
    }
}
