//! What nobody tells the user of a data set.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use voronudge_geometry::Vector;

/// What a set was made with. Lengths are in ℓ₀ of the whole tissue, times in 1/K_P.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Name of the class.
    pub class: String,
    /// Seed of the set.
    pub seed: u64,
    /// Parameters of the model, by the names of reports.
    pub parameters: BTreeMap<String, f64>,
    /// What acts that the base model lacks, by the names of reports.
    #[serde(default)]
    pub effect: Option<String>,
    /// σ_r of a coordinate, and σ_v of a component in units of the root mean square velocity.
    pub noise: [f64; 2],
    /// Mean distance that a cell moves from the first frame to the second; 0 of a single frame.
    pub mean_step: f64,
    /// x₀, y₀, x₁, y₁ of the box or of the field of view.
    pub field_of_view: [f64; 4],
    /// Cells in view that were not seen, or not by themselves, frame by frame.
    pub hidden: Vec<Hidden>,
    /// Number of cells that are detected as two.
    pub doubled: usize,
}

/// Something that was not seen in a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// The frame.
    pub frame: usize,
    /// Why.
    pub kind: Kind,
    /// Where the cell is; of a merged detection the two cells, of which one detection is missing.
    pub sites: Vec<[f64; 2]>,
}

/// Why a cell was not seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Never detected.
    Missed,
    /// Not detected in this frame.
    Gap,
    /// Taken for one with its neighbour.
    Merged,
}

impl Hidden {
    /// With places seen from a corner.
    pub(super) fn from(mut self, corner: Vector<f64>) -> Self {
        self.sites.iter_mut().for_each(|site| *site = [site[0] - corner.x, site[1] - corner.y]);
        self
    }
}
