//! The plane, its boundaries and the Voronoi tessellation.
//!
//! Topology is decided on `f64` by triangulation and flips; every formula of the geometry is generic over [`Scalar`], or its [`Arithmetic`], so the same code
//! gives values on `f64` and exact derivatives on dual numbers, at frozen topology.
//!
//! There is no physics here.
//!
//! ```
//! use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, Tessellation, Vector};
//!
//! // Two offset rows of a triangular lattice: every Voronoi cell is a regular hexagon.
//! let (dx, dy) = (1.0, 3f64.sqrt() / 2.0);
//! let mut positions = Vec::new();
//! for row in 0..4 {
//!     for column in 0..4 {
//!         positions.push(Vector::new(column as f64 * dx + 0.5 * (row % 2) as f64, row as f64 * dy));
//!     }
//! }
//! let domain = Domain::Periodic(PeriodicBox::new([4.0 * dx, 4.0 * dy])?);
//! let tessellation = Tessellation::new(&positions, domain)?;
//! let mut polygon = CellPolygon::<f64>::default();
//! polygon.fill(&tessellation, &positions, 5);
//! assert_eq!(polygon.len(), 6);
//! assert!((polygon.shape().area - dx * dy).abs() < 1e-14);
//! # Ok::<(), voronudge_geometry::Error>(())
//! ```

mod builder;
mod by_sides;
mod by_square;
mod centroid;
mod domain;
mod error;
mod field_of_view;
mod gaussian_patch;
mod grid;
mod honeycomb;
mod hull;
mod interface;
mod lanes;
mod moving;
mod overlap;
mod places;
mod plane;
mod polygon;
mod region;
mod scalar;
mod side;
mod tangent;
mod tessellation;
mod transition;

pub use by_sides::{Batch, BySides};
pub use by_square::{BySquare, Overlap};
pub use centroid::centroid_slopes;
pub use domain::{Domain, PeriodicBox};
pub use error::Error;
pub use field_of_view::{Certainty, Certificate, FieldOfView, Seen, Visibility};
pub use grid::{Grid, Patch};
pub use honeycomb::honeycomb;
pub use interface::Interface;
pub use lanes::Lanes;
pub use moving::{MovingTessellation, Renewal};
pub use overlap::{SidePiece, overlaps, side_pieces};
pub use places::Places;
pub use plane::{
    Corner, Outer, Vector, circumcentre, cross, dot, quarter_turn, side_direction, side_direction_slope,
};
pub use polygon::{CellPolygon, Shape, areas, perimeters, polygons, shape_tensors};
pub use region::Region;
pub use scalar::{Arithmetic, Elementary, Scalar, lift};
pub use side::Side;
pub use tangent::Tangent;
pub use tessellation::{Tessellation, Triangle};
pub use transition::Transition;
