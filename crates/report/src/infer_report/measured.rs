//! What positions and velocities are measurements of.

use super::FlowWindow;
use schemars::JsonSchema;
use serde::Serialize;

/// Which point of a cell its position is: its Voronoi site, its centroid, or a point between the two.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredPositions {
    /// Which points the positions were taken to be.
    pub are: PositionKind,
    /// Share of the way from the site (0) to the centroid (1) at which the positions lie.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub share: f64,
    /// 95 % interval of `share`; `null` unless it was estimated.
    pub ci95: Option<[f64; 2]>,
    /// Where this information comes from.
    pub source: MeasurementSource,
    /// Whether each cell has a position error of its own.
    pub own_errors: bool,
}

/// Which points of the cells the positions are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PositionKind {
    /// Voronoi sites.
    Sites,
    /// Centroids of the Voronoi polygons.
    Centroids,
    /// Points between site and centroid.
    Between,
}

/// Where the information about the measurement comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeasurementSource {
    /// It was declared.
    Declared,
    /// It was estimated.
    Estimated,
    /// It was neither declared nor estimated, and the usual case is assumed.
    Assumed,
}

/// What a grid point of a flow field represents.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredWindow {
    /// The kind of average over cells.
    pub kind: FlowWindow,
    /// Side of the square, or standard deviation of the Gaussian, in units of length.
    pub width: f64,
    /// 95 % interval of the width; `null` where it was declared.
    pub ci95: Option<[f64; 2]>,
    /// Whether both kind and width were declared.
    pub declared: bool,
    /// The kinds of window that were tried, the likeliest first.
    pub tried: Vec<TriedWindow>,
}

/// A kind of window that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TriedWindow {
    /// The kind of average over cells.
    pub kind: FlowWindow,
    /// Best width of a window of this kind, in units of length.
    pub width: f64,
    /// Rise of −2 log restricted likelihood above that of the likeliest kind.
    pub rise: f64,
    /// K_P alpha with this window, in 1/time, from the quick fit by which the kind is chosen.
    #[serde(rename = "K_P_alpha")]
    pub chiral_coefficient: f64,
}
