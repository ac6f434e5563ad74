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
            Self::Cells { .. } | Self::Frames { .. } => None,
        }
    }
}
