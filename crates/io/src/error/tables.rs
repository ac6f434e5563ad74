//! Faults of tables of tracks and of vectors.

/// Why a table of tracks or of vectors cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableFault {
    /// No bytes, or nothing but blank lines.
    #[error("is empty, a table with a header line is needed")]
    Empty,
    /// A gzip stream that cannot be decompressed.
    #[error("cannot be decompressed: {0}")]
    Gzip(String),
    /// A gzip stream that grows beyond reason.
    #[error("decompresses to more than {limit} bytes")]
    TooLong {
        /// The most that is read.
        limit: u64,
    },
    /// More rows than can be meant.
    #[error("has more than {limit} rows of spots")]
    TooManyRows {
        /// The most that are read.
        limit: usize,
    },
    /// A header and nothing below it.
    #[error("has a header but no data rows")]
    NoRows,
    /// Rows, but none belongs to a track.
    #[error("none of its {spots} spots belongs to a track (column \"{column}\" has no numbers)")]
    NoTracks {
        /// Spots read.
        spots: usize,
        /// Column of the track.
        column: String,
    },
    /// A column is not there.
    #[error("no column for the {role}: looked for {}, found {}", looked.join(", "), found.join(", "))]
    MissingColumn {
        /// What the column is needed for.
        role: &'static str,
        /// The names looked for.
        looked: Vec<String>,
        /// The columns of the file.
        found: Vec<String>,
        /// How columns are named, for the hint.
        example: &'static str,
    },
    /// A row of another length than the header.
    #[error("has {found} fields, the header has {expected}")]
    FieldCount {
        /// Fields in this row.
        found: u64,
        /// Fields in the header.
        expected: u64,
    },
    /// A field that is not the number it should be.
    #[error("column \"{column}\" holds \"{text}\", {expected} is needed")]
    NotANumber {
        /// The column.
        column: String,
        /// The field.
        text: String,
        /// What is needed, in words.
        expected: &'static str,
    },
    /// Frame numbers too far apart.
    #[error("frames run from {first} to {last}, more than {limit} frames are not taken")]
    TooManyFrames {
        /// Smallest frame number.
        first: i64,
        /// Largest frame number.
        last: i64,
        /// The most frames taken.
        limit: usize,
    },
    /// Too many tracks times frames.
    #[error("{frames} frames of {tracks} tracks need {bytes} bytes, the limit is {limit}")]
    TooLarge {
        /// Frames.
        frames: usize,
        /// Tracks.
        tracks: usize,
        /// Bytes of the positions.
        bytes: u64,
        /// The most bytes taken.
        limit: u64,
    },
    /// A file of bytes that are no text.
    #[error("is not text, a table is needed")]
    NotText,
    /// Columns were named, but there is no line of names.
    #[error("begins with numbers, so it has no header in which to look for columns by name")]
    NoHeader,
    /// One component of a displacement present, the other not.
    #[error("half of the displacement is missing (\"{u}\", \"{v}\")")]
    HalfMissing {
        /// The field of the component along x.
        u: String,
        /// The field of the component along y.
        v: String,
    },
    /// A row that is on no point of the grid that the other rows form.
    #[error("{axis} is {value}, but the points of the grid are at {first} and every {spacing} from there")]
    OffGrid {
        /// `x` or `y`.
        axis: char,
        /// The coordinate.
        value: f64,
        /// Coordinate of the first point of the grid.
        first: f64,
        /// Distance of the points.
        spacing: f64,
    },
    /// Two rows for one point of the grid.
    #[error("a second row for the grid point ({x}, {y}) in frame {frame}")]
    NodeTwice {
        /// x as in the table.
        x: f64,
        /// y as in the table.
        y: f64,
        /// Frame as in the table; 0 where it has none.
        frame: i64,
    },
    /// Two rows for one track in one frame.
    #[error("a second row for track {track} in frame {frame}")]
    SpotTwice {
        /// Track as in the table.
        track: i64,
        /// Frame as in the table.
        frame: i64,
    },
    /// The table cannot be split into fields.
    #[error("cannot be read as a table: {0}")]
    Unreadable(String),
}

impl TableFault {
    pub(super) fn hint(&self) -> Option<String> {
        let text = match self {
            Self::MissingColumn { example, .. } => return Some(format!("name the columns, e.g. {example}")),
            Self::Empty => "export the table again with its header line",
            Self::Gzip(_) => "the file was probably cut while it was copied; copy it again",
            Self::TooManyRows { .. } => "split the table into several movies",
            Self::TooLong { .. } => "export fewer columns, or split the table",
            Self::NoRows => "export the table again; was the track filter empty?",
            Self::NoTracks { .. } => "link the spots to tracks before the export",
            Self::FieldCount { .. } => "the row was probably cut; export the table again",
            Self::NotANumber { text, .. } if text.contains(',') => "write decimal points, not decimal commas",
            Self::NotANumber { .. } => "correct or remove this row",
            Self::TooManyFrames { .. } => {
                "is the frame column a time? name the column that counts images from zero"
            }
            Self::TooLarge { .. } => "drop short tracks, or import fewer frames at a time",
            Self::NotText => "export the vectors as text in UTF-8, or give displacements of pixels as .npy",
            Self::NoHeader => "leave the names out if the columns are x, y, u, v, or add a line of names",
            Self::HalfMissing { .. } => "a missing vector is NaN in both components",
            Self::OffGrid { .. } => {
                "vectors must lie on a rectangular grid; export the table before any interpolation or rotation"
            }
            Self::NodeTwice { .. } => {
                "if the table holds several frames, name their column with --frame-column, or give one \
                 file for each frame"
            }
            Self::SpotTwice { .. } => {
                "each cell needs a track of its own: a track is in one place in each frame"
            }
            Self::Unreadable(_) => {
                "open the table in a text editor: it should have one line for each cell and frame"
            }
        };
        Some(text.into())
    }
}
