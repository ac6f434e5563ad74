//! What positions and velocities are measurements of.

use super::FlowWindow;
use schemars::JsonSchema;
use serde::Serialize;

/// What of a cell its position is: its Voronoi site, its centroid, or a point between.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredPositions {
    /// What the positions were taken for.
    pub are: PositionKind,
    /// The share of the way from the site to the centroid.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub share: f64,
    /// 95 % interval of the share; `null` where it was declared.
    pub ci95: Option<[f64; 2]>,
    /// Where this comes from.
    pub source: MeasurementSource,
    /// Whether cells have errors of their own.
    pub own_errors: bool,
}

/// What positions are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PositionKind {
    /// Voronoi sites.
    Sites,
    /// Centroids of Voronoi polygons.
    Centroids,
    /// Points between the two.
    Between,
}

/// Where what is said of the measurement comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeasurementSource {
    /// It was declared.
    Declared,
    /// It was estimated.
    Estimated,
    /// It is what is usual: nothing was declared or estimated.
    Assumed,
}

/// What a grid point of a flow field stands for.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredWindow {
    /// The kind of average.
    pub kind: FlowWindow,
    /// Side of a square, standard deviation of a Gaussian, in units of length.
    pub width: f64,
    /// 95 % interval of the width; `null` where it was declared.
    pub ci95: Option<[f64; 2]>,
    /// Whether kind and width were declared.
    pub declared: bool,
    /// The kinds that were tried, the likeliest first.
    pub tried: Vec<TriedWindow>,
}

/// A kind of window that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TriedWindow {
    /// The kind of average.
    pub kind: FlowWindow,
    /// Its best width.
    pub width: f64,
    /// By how much −2 log restricted likelihood is higher than for the likeliest kind.
    pub rise: f64,
    /// K_P alpha with it, by the quick fit that decides.
    #[serde(rename = "K_P_alpha")]
    pub chiral_coefficient: f64,
}
