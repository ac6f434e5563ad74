//! Spots of a table, and the kinds of tables that have some.

/// The kind of table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    TrackMate,
    Tracks,
    /// Corners of outlines, row after row; without a column of frames all are in one.
    Outlines,
    /// Points without tracks; without a column of frames all are in one.
    Points,
}

/// A spot that belongs to a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    pub(crate) track: i64,
    pub(crate) frame: i64,
    pub(crate) x: f64,
    pub(crate) y: f64,
}
