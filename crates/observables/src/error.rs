//! What cannot be measured.

use thiserror::Error;

/// Why there is nothing to measure.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// Frames that do not hold the same cells.
    #[error("frame {frame} has {found} cells, but the first has {cells}")]
    Cells {
        /// The frame.
        frame: usize,
        /// Cells of the first.
        cells: usize,
        /// Cells of this one.
        found: usize,
    },
    /// Frames and what goes with them in different numbers.
    #[error("{found} {what} for {frames} frames")]
    Frames {
        /// What there is one of for each frame.
        what: &'static str,
        /// Frames.
        frames: usize,
        /// How many there are.
        found: usize,
    },
    /// The cells of a frame cannot be tessellated.
    #[error("frame {frame}: {source}")]
    Tessellation {
        /// The frame.
        frame: usize,
        /// What the tessellation said.
        source: voronudge_geometry::Error,
    },
    /// The director cannot be smoothed so.
    #[error(
        "the director is to be smoothed over {width} spacings, but the width must be positive and {largest:.3} at most"
    )]
    SmoothingWidth {
        /// Standard deviation of the Gaussian, in mean spacings.
        width: f64,
        /// A quarter of a side of the periodic box.
        largest: f64,
    },
    /// Fewer frames than a course of fluctuations needs.
    #[error("{found} frames, but fluctuations need {required} at least")]
    TooFewFrames {
        /// How many there are.
        found: usize,
        /// How many it takes.
        required: usize,
    },
    /// Frames that are not evenly spaced.
    #[error("the time from frame {frame} of those chosen to the next is not that between the others")]
    UnevenFrames {
        /// The first of such frames.
        frame: usize,
    },
    /// No box or window whose waves are the same in all frames.
    #[error("there are no waves up to this wave number that all frames have")]
    NoWaves,
    /// Cells that all stand still.
    #[error("no cell moves, or none has a velocity")]
    NothingMoves,
    /// Lags that leave nothing of the frames.
    #[error("lags reach {longest} frames, which is more than a third of {frames}")]
    LongLags {
        /// Longest lag in frames.
        longest: usize,
        /// Frames.
        frames: usize,
    },
    /// The caller broke off.
    #[error("interrupted")]
    Interrupted,
    /// Nothing can be said of any cell.
    #[error("no cell has all its neighbours in view")]
    NothingInView,
}

impl Error {
    /// What can be done about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Tessellation { source, .. } => source.hint(),
            Self::NothingInView => Some(
                "a cell counts if it and all its neighbours lie well within the field of view; take a larger field, or state field_of_view in dataset.toml",
            ),
            Self::SmoothingWidth { .. } => {
                Some("1.5 spacings smooth over the next neighbours; small boxes need less")
            }
            Self::TooFewFrames { .. } => Some("errors of fluctuations take hundreds of frames"),
            Self::UnevenFrames { .. } => Some("choose frames with one step, as in --frames 4..16"),
            Self::NoWaves => Some(
                "waves must fit into the box, which is not to change, or twice into the upright rectangle in which every cell would have been seen; try a larger wave number",
            ),
            Self::NothingMoves => {
                Some("fluctuations are those of cells that move; leave out frames in which they are at rest")
            }
            Self::LongLags { .. } => Some("take shorter lags, or more frames"),
            Self::Cells { .. } | Self::Frames { .. } | Self::Interrupted => None,
        }
    }
}
