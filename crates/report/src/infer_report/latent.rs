//! What was wrong with detections.

use schemars::JsonSchema;
use serde::Serialize;

/// Cells that were not detected, and detections that are no cells, over all frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
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
    #[schemars(range(min = 0.0, max = 1.0))]
    pub missed_rate: f64,
}
