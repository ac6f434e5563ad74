//! Tracks that were fitted themselves.

use schemars::JsonSchema;
use serde::Serialize;

/// The tracks of a movie, and how the motion along them was integrated.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TracksReport {
    /// Number of tracks after joining.
    pub tracks: usize,
    /// How often a track jumped to another cell, where it was cut.
    pub cut: usize,
    /// Tracks that broke and went on under another name, and were joined.
    pub joined: usize,
    /// Cells times frames within tracks in which the cell was not seen.
    pub gaps: usize,
    /// Tracks that begin after the first frame.
    pub begun: usize,
    /// Tracks that end before the last frame.
    pub ended: usize,
    /// Steps of integration from one frame to the next.
    #[schemars(range(min = 1))]
    pub substeps: usize,
    /// Order of the rule of integration in the length of a step.
    #[schemars(extend("enum" = [2, 4]))]
    pub order: usize,
    /// By how much a finer rule would change the coefficients: the largest change, in standard errors.
    pub integration_error: f64,
    /// Position noise that the tracks imply, in units of ℓ₀.
    pub sigma_r: f64,
    /// What the model misses of a displacement from frame to frame, in units of ℓ₀.
    pub sigma_d: f64,
    /// Translation of all cells over each interval, drift of the stage among it, in units of length, y up; empty if none was allowed.
    pub drifts: Vec<[f64; 2]>,
}
