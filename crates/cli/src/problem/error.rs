//! Why a data set makes no problem.

use voronudge_model::EnvironmentError;

/// Why a data set makes no problem.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Data that cannot be used like this.
    #[error(transparent)]
    Data(#[from] voronudge_io::Error),
    /// A frame whose cells cannot be tessellated; cells are numbered as in the data set.
    #[error("frame {frame}: {source}")]
    Frame {
        /// Number of the frame in the data set.
        frame: usize,
        /// What is wrong with it.
        source: voronudge_geometry::Error,
    },
    /// A field of view or a grid that is none.
    #[error(transparent)]
    Geometry(#[from] voronudge_geometry::Error),
    /// Frames that cannot be fitted.
    #[error(transparent)]
    Fit(#[from] voronudge_infer::Error),
    /// What surrounds the cells cannot be used.
    #[error(transparent)]
    Surroundings(#[from] EnvironmentError),
    /// No velocities, and no tracks to derive them from.
    #[error("there is one frame and no velocities: nothing tells how cells move")]
    NothingTellsMotion,
    /// No frames.
    #[error("there is no frame")]
    NoFrame,
    /// A frame behind the last one.
    #[error("frame {frame} does not exist, the data set has {frames} frames")]
    NoSuchFrame {
        /// The frame asked for.
        frame: usize,
        /// Number of frames.
        frames: usize,
    },
}

impl Error {
    /// Advice on what to change, if there is any.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Data(error) => error.hint(),
            Self::Frame { source, .. } => source.hint().map(str::to_owned),
            Self::Geometry(error) => error.hint().map(str::to_owned),
            Self::Fit(error) => error.hint().map(str::to_owned),
            Self::Surroundings(_) => Some("check the data".into()),
            Self::NothingTellsMotion => Some(
                "give velocities, a flow field, or the positions of the same cells in two frames or more"
                    .into(),
            ),
            Self::NoSuchFrame { .. } => Some("frames count from zero".into()),
            Self::NoFrame => None,
        }
    }
}
