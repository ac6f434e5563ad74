//! Tracks that were fitted themselves.

use schemars::JsonSchema;
use serde::Serialize;

/// The tracks of a movie, and how the motion along them was integrated.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TracksReport {
    /// Number of tracks after joining.
    pub tracks: usize,
    /// Number of times that a track jumped to another cell; it was cut there.
    pub cut: usize,
    /// Number of times that a track broke and continued under another name; the two were joined.
    pub joined: usize,
    /// Number of gaps within tracks: frames in which the cell was not seen, summed over tracks.
    pub gaps: usize,
    /// Number of tracks that begin after the first frame.
    pub begun: usize,
    /// Number of tracks that end before the last frame.
    pub ended: usize,
    /// Number of integration steps from one frame to the next.
    #[schemars(range(min = 1))]
    pub substeps: usize,
    /// Order of the integration rule in the step length.
    #[schemars(extend("enum" = [2, 4]))]
    pub order: usize,
    /// Largest change of a coefficient that a finer integration rule would make, in standard errors.
    pub integration_error: f64,
    /// Position noise implied by the tracks, in units of ℓ₀.
    pub sigma_r: f64,
    /// Standard deviation of what the model misses of a displacement from frame to frame, in units of ℓ₀.
    pub sigma_d: f64,
    /// Translation of all cells in each interval, which includes drift of the stage, in units of length, y up; empty if none was allowed.
    pub drifts: Vec<[f64; 2]>,
}
