//! How the cells were measured, as far as the results depend on it.

use super::{LatentCells, MeasuredPositions, MeasuredWindow, TracksReport};
use schemars::JsonSchema;
use serde::Serialize;

/// What was seen of the tissue, and how.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Measurement {
    /// Where every cell would have been seen; `null` in a periodic box.
    pub field_of_view: Option<SeenRegion>,
    /// Cells whose polygon and those of their neighbours are certain, over all frames.
    pub certain: usize,
    /// Cells that were seen, but whose polygon or that of a neighbour could be another one, over all frames.
    pub uncertain: usize,
    /// Cells outside the field of view, over all frames.
    pub outside: usize,
    /// Cells that were not detected, and the like; `null` with `--complete false`.
    pub latent: Option<LatentCells>,
    /// The tracks; `null` where velocities were fitted.
    pub tracks: Option<TracksReport>,
    /// What of a cell its position is.
    pub positions: MeasuredPositions,
    /// What a grid point of a flow field stands for; `null` for velocities of cells.
    pub window: Option<MeasuredWindow>,
}

/// A region where every cell would have been seen.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeenRegion {
    /// Where it comes from.
    pub source: RegionSource,
    /// Corners of the region as stated, with y as in the files; `null` for the hull, which each frame has of its own.
    pub corners: Option<Vec<[f64; 2]>>,
    /// How far from its border the circumdisks of certain triangles stay, in units of length.
    #[schemars(range(min = 0.0))]
    pub margin: f64,
}

/// Where a field of view comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RegionSource {
    /// Given on the command line.
    Given,
    /// Stated by the data set.
    DataSet,
    /// Nothing was stated: it is the hull of the cells of each frame.
    Hull,
}
