//! What can be wrong with detections.

use voronudge_geometry::Vector;

/// How a frame differs from what was detected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ChangeKind {
    /// A cell that was not detected.
    Inserted,
    /// A detection that is no cell.
    Deleted,
    /// One detection of two cells.
    Split,
    /// Two detections of one cell.
    Merged,
}

impl ChangeKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Inserted, Self::Deleted, Self::Split, Self::Merged];
}

/// One difference between a frame and what was detected.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// What it is.
    pub kind: ChangeKind,
    /// Detections that it takes away, by their number in the frame.
    pub removed: Vec<usize>,
    /// Where it puts cells.
    pub added: Vec<Vector<f64>>,
    /// The labels of those, where cells of each label have parameters of their own: the ones that suit the velocities best.
    pub labels: Vec<Option<i64>>,
    /// Standard error of a coordinate of those.
    pub standard_error: f64,
    /// By how much −2 log likelihood falls, beyond the cost of the places, of having looked for them, and of the rate of such
    /// faults.
    pub evidence: f64,
}

impl Change {
    /// The place of a cell that is put in where none was detected.
    pub(super) fn insertion(&self) -> Option<Vector<f64>> {
        self.added.first().copied().filter(|_| self.kind == ChangeKind::Inserted)
    }
}
