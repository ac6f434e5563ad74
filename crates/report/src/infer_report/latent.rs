//! What was wrong with detections.

use schemars::JsonSchema;
use serde::Serialize;

/// Cells that were not detected, and detections that are not cells, over all frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LatentCells {
    /// Number of cells that were added where none was detected.
    pub inserted: usize,
    /// Number of detections that were removed.
    pub deleted: usize,
    /// Number of detections that are two cells.
    pub split: usize,
    /// Number of cells that were detected twice.
    pub merged: usize,
    /// Share of the cells that is not detected, as given or as estimated.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub missed_rate: f64,
}
