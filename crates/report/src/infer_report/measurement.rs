//! How the cells were measured, as far as the results depend on it.

use super::{LatentCells, MeasuredPositions, MeasuredWindow, TracksReport};
use schemars::JsonSchema;
use serde::Serialize;

/// What was observed of the tissue, and how.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Measurement {
    /// The region in which every cell would have been seen; `null` in a periodic box.
    pub field_of_view: Option<SeenRegion>,
    /// Number of cells, over all frames, whose polygon is certain, as are those of their neighbours.
    pub certain: usize,
    /// Number of cells, over all frames, that were seen but whose polygon, or that of a neighbour, could be a different one.
    pub uncertain: usize,
    /// Number of cells outside the field of view, over all frames.
    pub outside: usize,
    /// Cells that were not detected, and detections that are not cells; `null` with `--complete false`.
    pub latent: Option<LatentCells>,
    /// The tracks that were fitted; `null` where velocities were fitted.
    pub tracks: Option<TracksReport>,
    /// Which point of a cell its position is.
    pub positions: MeasuredPositions,
    /// What a grid point of a flow field represents; `null` for velocities of cells.
    pub window: Option<MeasuredWindow>,
}

/// A region in which every cell would have been seen.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeenRegion {
    /// Where the region comes from.
    pub source: RegionSource,
    /// Corners of the region as stated, in units of length, with y as in the files; `null` for the hull, which is different in each frame.
    pub corners: Option<Vec<[f64; 2]>>,
    /// Distance that the circumdisks of certain triangles keep from the border of the region, in units of length.
    #[schemars(range(min = 0.0))]
    pub margin: f64,
}

/// Where a field of view comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RegionSource {
    /// It was given on the command line.
    Given,
    /// It is stated by the data set.
    DataSet,
    /// Nothing was stated, so it is the hull of the cells of each frame.
    Hull,
}
