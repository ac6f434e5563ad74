//! The vectors of a table, and names of its columns.

use crate::note::Note;

/// Names of the columns, where they are not to be recognised automatically.
///
/// A name is looked up as written, then ignoring case, blanks, hyphens, underscores and units in
/// brackets.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FlowColumnNames {
    /// The column that counts frames.
    pub frame: Option<String>,
    /// x of the grid point.
    pub x: Option<String>,
    /// y of the grid point.
    pub y: Option<String>,
    /// The displacement along x.
    pub u: Option<String>,
    /// The displacement along y.
    pub v: Option<String>,
    /// The column that is not zero where the vector is missing.
    pub mask: Option<String>,
}

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Vector {
    /// Line, counted from 1; 0 in a file without lines.
    pub(crate) line: u64,
    pub(crate) frame: i64,
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// NaN in both components where missing.
    pub(crate) displacement: [f64; 2],
}

/// The vectors of a table, in the order of its rows; at least one.
#[derive(Debug, Default)]
pub(crate) struct VectorTable {
    pub(crate) vectors: Vec<Vector>,
    /// The unit of displacements that the header states in brackets.
    pub(crate) unit: Option<String>,
    /// The unit of places, likewise.
    pub(crate) place_unit: Option<String>,
    /// Which columns or variables were taken for what, in words.
    pub(crate) columns: String,
    /// What else was understood.
    pub(crate) notes: Vec<Note>,
}
