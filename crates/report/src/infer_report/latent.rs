//! What was wrong with detections.

use serde::Serialize;

/// Cells that were not detected, and detections that are no cells, over all frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LatentCells {
    /// Cells put in where none was detected.
    pub inserted: usize,
    /// Detections taken away.
    pub deleted: usize,
    /// Detections that are two cells.
    pub split: usize,
    /// Cells that were detected twice.
    pub merged: usize,
    /// Share of the cells that is not detected: as given, or estimated.
    pub missed_rate: f64,
}
