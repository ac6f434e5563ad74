//! Which snapshots are explained.

use super::flow::FlowArguments;
use crate::arguments::DataSetArguments;
use crate::failure::Failure;
use crate::problem;
use clap::{Args, ValueEnum};
use std::path::Path;
use voronudge_io::{DataSet, FrameSelection};
use voronudge_report::infer_report::{NoiseSource, RegionSource};

#[derive(Debug, Clone, Args)]
pub(crate) struct SnapshotArguments {
    #[command(flatten)]
    pub data: DataSetArguments,
    /// Frames to fit together, counted from zero: `6`, `4..16` (end excluded) or `4,7,9` [default: all that have
    /// velocities].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    pub frames: Option<FrameSelection>,
    /// Mean velocity to subtract before the fit, because a drifting stage adds one.
    #[arg(long, value_enum, default_value_t = MeanToRemove::Auto)]
    pub remove_mean: MeanToRemove,
    /// Fit a smooth flow on top of the model, which need not explain it: in each frame, polynomials of the position
    /// up to this degree, 0 to 6 [default: none].
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u32).range(0..=6), allow_negative_numbers = true)]
    pub background: Option<u32>,
    /// In an open field of view, treat polygons larger than this multiple of the median area as holes in the data.
    #[arg(long, value_name = "FACTOR", default_value_t = 3.0, allow_negative_numbers = true)]
    pub largest_area: f64,
    #[command(flatten)]
    pub flow: FlowArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeanToRemove {
    /// The median of each frame in an open field of view, unless velocities of cells are given; otherwise none.
    Auto,
    /// No mean velocity.
    None,
    /// The median of the velocities used in each frame.
    PerFrame,
}

impl From<MeanToRemove> for problem::MeanToRemove {
    fn from(asked: MeanToRemove) -> Self {
        match asked {
            MeanToRemove::Auto => Self::Auto,
            MeanToRemove::None => Self::None,
            MeanToRemove::PerFrame => Self::PerFrame,
        }
    }
}

/// Where what is stated of the measurement comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stated {
    /// Noise levels, if both were stated.
    pub noise: NoiseSource,
    /// The field of view, if it is open.
    pub region: RegionSource,
}

impl SnapshotArguments {
    /// Refuses what needs no data to be seen wrong.
    pub fn check(&self) -> Result<(), Failure> {
        check_largest_area(self.largest_area)
    }

    /// Where what is stated of the measurement comes from.
    pub fn stated(&self, data: &DataSet) -> Stated {
        let from_flags = self.data.position_noise.is_some() || self.data.velocity_noise.is_some();
        Stated {
            noise: if from_flags { NoiseSource::Given } else { NoiseSource::DataSet },
            region: match &data.field_of_view {
                Some(_) if self.data.field_of_view.is_some() => RegionSource::Given,
                Some(_) => RegionSource::DataSet,
                None => RegionSource::Hull,
            },
        }
    }

    /// The same of the folder of another data set, all frames.
    pub fn of_folder(&self, folder: &Path) -> Self {
        Self { data: self.data.of_folder(folder), frames: None, ..self.clone() }
    }

    /// What the data are called: the name of their folder or file.
    pub fn title(&self) -> String {
        let named = self.data.dataset.as_ref().or(self.data.positions.as_ref());
        let name = named.and_then(|path| path.file_name());
        name.map_or_else(|| "data".into(), |name| name.to_string_lossy().into_owned())
    }
}

/// Refuses a multiple of the median area that is none.
pub(crate) fn check_largest_area(factor: f64) -> Result<(), Failure> {
    if factor.is_finite() && factor > 0.0 {
        return Ok(());
    }
    let text = format!("--largest-area is {factor}, but it must be finite and above zero");
    Err(Failure::new(text).with_hint("leave it out for 3 times the median area"))
}
