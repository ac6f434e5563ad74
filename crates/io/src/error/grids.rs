//! Faults of velocities on a grid.

use std::path::PathBuf;

/// Why a flow field cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridFault {
    /// A field whose grid is not known.
    #[error("the {axis} coordinates of this flow field are not given{}", searched.as_ref()
        .map(|path| format!(": there is no {}", path.display())).unwrap_or_default())]
    MissingCoordinates {
        /// `x` or `y`.
        axis: char,
        /// The file that was looked for, if a folder was given.
        searched: Option<PathBuf>,
    },
    /// Coordinates of a grid on which nothing is given.
    #[error("holds {axis} coordinates of a flow field, but there is no flow field")]
    MissingField {
        /// `x` or `y`.
        axis: char,
    },
    /// The coordinates do not count the points of the field.
    #[error("has {found} {axis} coordinates, but the flow field has {expected} points along {axis}")]
    CoordinateCount {
        /// `x` or `y`.
        axis: char,
        /// Coordinates found.
        found: usize,
        /// Points of the field along the axis.
        expected: usize,
    },
    /// The field has another number of frames than the positions.
    #[error("number of frames is {found}, but that of the positions is {positions}")]
    FrameCount {
        /// Frames of the field.
        found: usize,
        /// Frames of the positions.
        positions: usize,
    },
    /// Too few points for a spacing.
    #[error("number of grid points along {axis} is {found}, at least 2 are needed")]
    TooFew {
        /// `x` or `y`.
        axis: char,
        /// Points found.
        found: usize,
    },
    /// A coordinate that is NaN or infinite.
    #[error("{axis} coordinate {index} is {value}")]
    NotFinite {
        /// `x` or `y`.
        axis: char,
        /// Index along the axis, from zero.
        index: usize,
        /// The coordinate.
        value: f64,
    },
    /// Coordinates that stand still or turn back.
    #[error("{axis} coordinate {index} is {value} after {before}, so they neither ascend nor descend")]
    Turns {
        /// `x` or `y`.
        axis: char,
        /// Index along the axis, from zero.
        index: usize,
        /// The coordinate before.
        before: f64,
        /// The coordinate.
        value: f64,
    },
    /// Coordinates at uneven distances.
    #[error("{axis} coordinate {index} is {value}, on an even grid it is {expected}")]
    Uneven {
        /// `x` or `y`.
        axis: char,
        /// Index along the axis, from zero.
        index: usize,
        /// The coordinate.
        value: f64,
        /// The coordinate if all distances were the same.
        expected: f64,
    },
    /// An infinite velocity.
    #[error("frame {frame}, row {row}, column {column}: infinite value ({x}, {y})")]
    Infinite {
        /// Frame, from zero.
        frame: usize,
        /// Index along y, from zero.
        row: usize,
        /// Index along x, from zero.
        column: usize,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
    },
    /// One component present, the other not.
    #[error("frame {frame}, row {row}, column {column}: half missing ({x}, {y})")]
    HalfMissing {
        /// Frame, from zero.
        frame: usize,
        /// Index along y, from zero.
        row: usize,
        /// Index along x, from zero.
        column: usize,
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
    },
    /// The grid reaches beyond the periodic box.
    #[error("the grid extends over {extent} along {axis}, but the box length is {length}")]
    BeyondBox {
        /// `x` or `y`.
        axis: char,
        /// Largest minus smallest coordinate.
        extent: f64,
        /// Box length along the axis.
        length: f64,
    },
    /// Several files, and one of them has more than its one frame.
    #[error("holds {frames} frames, but of several files each must be one frame")]
    SeveralFrames {
        /// Frames in the file.
        frames: usize,
    },
    /// Arrays of several files that differ in size.
    #[error("has {} rows and {} columns, but the first file has {} and {}", found[0], found[1], expected[0], expected[1])]
    OtherSize {
        /// Rows and columns of the file.
        found: [usize; 2],
        /// Rows and columns of the first file.
        expected: [usize; 2],
    },
    /// A table after arrays, or an array after tables.
    #[error("is an array after tables, or a table after arrays")]
    OtherKind,
    /// Columns were named, but an array has none.
    #[error("is an array, but columns of a table are named")]
    NoColumns,
    /// A grid spacing was asked for, but a table has its own.
    #[error("is a table, whose grid stays as it is, but a grid spacing is given")]
    NoPixels,
    /// Rows that fill next to nothing of their grid.
    #[error("has {rows} rows for a grid of {points} points")]
    Sparse {
        /// Rows of all tables.
        rows: usize,
        /// Points of the grid in one frame.
        points: u64,
    },
    /// Too many points times frames.
    #[error("{frames} frames of {points} grid points need {bytes} bytes, the limit is {limit}")]
    TooLarge {
        /// Frames.
        frames: usize,
        /// Points of the grid in one frame.
        points: u64,
        /// Bytes of the velocities.
        bytes: u64,
        /// The most bytes taken.
        limit: u64,
    },
    /// Squares smaller than a pixel.
    #[error("the grid spacing is {spacing}, but a pixel is {pixel}")]
    FinerThanPixels {
        /// The spacing asked for.
        spacing: f64,
        /// Side of a pixel.
        pixel: f64,
    },
    /// Squares so large that no grid is left.
    #[error("along {axis} there are {pixels} pixels of {pixel}, less than two squares of {spacing}")]
    TooCoarse {
        /// `x` or `y`.
        axis: char,
        /// Pixels along the axis.
        pixels: usize,
        /// Side of a pixel.
        pixel: f64,
        /// Side of a square.
        spacing: f64,
    },
}

impl GridFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::MissingCoordinates { .. } => {
                "put flow_x.npy and flow_y.npy beside flow.npy, or give them with --flow-x and --flow-y"
            }
            Self::MissingField { .. } => "add flow.npy, give --flow FILE, or remove the coordinates",
            Self::CoordinateCount { .. } => {
                "the axes of the flow field are frames, rows (y), columns (x), components; \
                 are rows and columns exchanged?"
            }
            Self::FrameCount { .. } => {
                "each frame of positions needs its flow field; the flow between n images has n − 1 frames, \
                 so leave out the last frame of the positions"
            }
            Self::TooFew { .. } => "a grid needs at least 2 × 2 points",
            Self::NotFinite { .. } => {
                "coordinates are needed also where velocities are missing; only velocities may be NaN"
            }
            Self::Turns { .. } | Self::Uneven { .. } => {
                "give one coordinate for each column or row, all at the same distance"
            }
            Self::Infinite { .. } => "a missing point is NaN in both components, never infinite",
            Self::HalfMissing { .. } => "set both components to NaN where the point is missing",
            Self::BeyondBox { .. } => {
                "check the box and the length unit, or cut the grid so that it covers the box once"
            }
            Self::SeveralFrames { .. } => "give this file alone, or one file for each frame",
            Self::OtherKind => "give only arrays or only tables",
            Self::NoColumns => "leave out --x-column and the like; they are for tables",
            Self::NoPixels => "leave out --grid-spacing; it is for arrays with a displacement for each pixel",
            Self::Sparse { .. } => {
                "vectors must lie on a rectangular grid; for tracked particles use import tracks"
            }
            Self::TooLarge { .. } => "import fewer frames at a time",
            Self::OtherSize { .. } => "all frames must come from images of the same size",
            Self::FinerThanPixels { .. } => {
                "give --grid-spacing in the unit of --pixel-size, not below one pixel, or leave it out"
            }
            Self::TooCoarse { .. } => "give --grid-spacing in the unit of --pixel-size, and smaller",
        };
        Some(text.into())
    }
}
