//! Faults of tables of tracks and of vectors.

/// The most names, and the most characters of a name or a field, that a message repeats.
const MOST_NAMES: usize = 10;
const MOST_CHARACTERS: usize = 40;

/// A text of a file as a message can show it: without control characters, and not longer than a line.
fn shown(text: &str) -> String {
    let mut own: String = text.chars().take(MOST_CHARACTERS).flat_map(char::escape_debug).collect();
    if text.chars().nth(MOST_CHARACTERS).is_some() {
        own.push('…');
    }
    own
}

/// The first of some names, and how many more there are.
fn few(names: &[String]) -> String {
    let first: Vec<String> = names.iter().take(MOST_NAMES).map(|name| shown(name)).collect();
    match names.len().saturating_sub(MOST_NAMES) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

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
    #[error("none of its {spots} spots belongs to a track (column \"{}\" has no numbers)", shown(column))]
    NoTracks {
        /// Spots read.
        spots: usize,
        /// Column of the track.
        column: String,
    },
    /// A column is not there.
    #[error("no column for the {role}: looked for {}, found {}", few(looked), few(found))]
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
    #[error("column \"{}\" holds \"{}\", {expected} is needed", shown(column), shown(text))]
    NotANumber {
        /// The column.
        column: String,
        /// The field.
        text: String,
        /// What is needed, in words.
        expected: &'static str,
    },
    /// A number of an array of tracks that is not what its column holds.
    #[error("row {row}, column {column} (from zero) is {value}, {expected} is needed")]
    ArrayRow {
        /// Row, from zero.
        row: usize,
        /// Column, from zero.
        column: usize,
        /// The number.
        value: f64,
        /// What is needed, in words.
        expected: &'static str,
    },
    /// A column that was taken for the track and holds names.
    #[error("column \"{}\" holds \"{}\", which is no number of a track", shown(column), shown(text))]
    Untracked {
        /// The column.
        column: String,
        /// What it holds.
        text: String,
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
    /// A file of another kind, as its first bytes tell.
    #[error("is {kind}, a table of text is needed")]
    AnotherKind {
        /// Which.
        kind: &'static str,
        /// How it becomes a table.
        advice: &'static str,
    },
    /// A file of MATLAB that is not whole, or whose variables do not go together.
    #[error("cannot be read as a file of MATLAB: {0}")]
    Matlab(String),
    /// A file of bytes that are no text.
    #[error("is not text, a table is needed")]
    NotText,
    /// Columns were named, but there is no line of names.
    #[error("begins with numbers, so it has no header in which to look for columns by name")]
    NoHeader,
    /// A table of cells without a line of names.
    #[error("begins with numbers, so nothing says which column is what")]
    NoNames,
    /// One component of a displacement present, the other not.
    #[error("half of the displacement is missing (\"{}\", \"{}\")", shown(u), shown(v))]
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
    /// XML that is cut or damaged.
    #[error("cannot be read as XML: {0}")]
    Xml(String),
    /// XML of another program.
    #[error("is XML of another kind ({root})")]
    OtherXml {
        /// Its outermost element.
        root: String,
    },
    /// An element that is not there.
    #[error("has no {element}")]
    NoElement {
        /// Its name.
        element: &'static str,
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
            Self::ArrayRow { .. } => {
                "columns are track, frame, (z,) y, x as in a tracks layer of napari, or frame, (z,) y, x as in a points layer"
            }
            Self::Untracked { .. } => {
                "import points follows cells that have no tracks; or name the column of the track with --track-column"
            }
            Self::TooManyFrames { .. } => {
                "is the frame column a time? name the column that counts images from zero"
            }
            Self::TooLarge { .. } => "drop short tracks, or import fewer frames at a time",
            Self::AnotherKind { advice, .. } => advice,
            Self::Matlab(_) => {
                "save it again from PIVlab (Export, MATLAB file), or its vectors as text; the copy may be cut"
            }
            Self::NotText => "export the table as text; displacements of pixels may be given as .npy",
            Self::NoHeader => "leave the names out if the columns are x, y, u, v, or add a line of names",
            Self::NoNames => {
                "add a first line of names, such as track,frame,x,y; rows of a tracks layer of napari are track,frame,y,x, and its .npy needs none"
            }
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
            Self::Xml(_) => "the file was probably cut while it was written or copied; save or copy it again",
            Self::OtherXml { .. } => "TrackMate saves <TrackMate> files, and exports tracks as <Tracks>",
            Self::NoElement { .. } => {
                "save the whole model in TrackMate after tracking, or export its tracks to XML"
            }
            Self::Unreadable(_) => {
                "open the table in a text editor: it should have one line for each cell and frame"
            }
        };
        Some(text.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_repeat_little_of_a_file() {
        let names: Vec<String> = (0..5000).map(|k| format!("{{\"x\": {k}\u{7}}}")).collect();
        let found = few(&names);
        assert!(found.ends_with("and 4990 more") && found.len() < 400, "{found}");
        assert!(!found.contains('\u{7}'));
        let fault =
            TableFault::NotANumber { column: "x".into(), text: "a".repeat(100_000), expected: "a number" };
        assert!(fault.to_string().len() < 200);
        assert_eq!(few(&["µ m".into(), "y".into()]), "µ m, y");
    }
}
