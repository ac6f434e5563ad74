use thiserror::Error;

/// Why a domain or a tessellation cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A box side that is not a positive finite number.
    #[error("box side {axis} is {length:e}, but it must be positive and finite, from 1e-100 to 1e100")]
    BoxSide {
        /// Name of the side: `x` or `y`.
        axis: char,
        /// The length given.
        length: f64,
    },
    /// A Lees–Edwards offset that is not finite, or of very many boxes.
    #[error(
        "the shear offset of the box is {offset}, but it must be finite and at most {limit} in magnitude"
    )]
    BoxOffset {
        /// The offset given.
        offset: f64,
        /// The largest magnitude possible.
        limit: f64,
    },
    /// A grid whose origin is not finite or whose spacing is not positive.
    #[error(
        "the grid has origin {origin} and spacing {spacing} along {axis}, but the first must be \
         finite and the second positive"
    )]
    Grid {
        /// Name of the axis: `x` or `y`.
        axis: char,
        /// Coordinate of the first square's centre.
        origin: f64,
        /// Distance between centres.
        spacing: f64,
    },
    /// A coordinate that is NaN or infinite, or so far away that positions lose their meaning.
    #[error("cell {cell} is at ({x}, {y}), which is not a usable position")]
    Position {
        /// Index of the cell.
        cell: usize,
        /// Its x coordinate.
        x: f64,
        /// Its y coordinate.
        y: f64,
    },
    /// Fewer cells than a tessellation needs.
    #[error("{found} cells, but a tessellation needs at least {required}")]
    TooFewCells {
        /// Number of cells given.
        found: usize,
        /// Number of cells needed.
        required: usize,
    },
    /// Two cells at one point (after wrapping into a periodic box).
    #[error("cells {first} and {second} are at the same point ({x}, {y})")]
    DuplicateCells {
        /// Index of the first of the two cells.
        first: usize,
        /// Index of the second.
        second: usize,
        /// Their x coordinate.
        x: f64,
        /// Their y coordinate.
        y: f64,
    },
    /// All cells of an open field of view on one line.
    #[error("all {cells} cells lie on one line")]
    Collinear {
        /// Number of cells.
        cells: usize,
    },
    /// Positions whose Delaunay triangulation could not be made consistent across the periodic boundary.
    #[error("the periodic triangulation of {cells} cells is inconsistent near cell {cell}")]
    Inconsistent {
        /// Number of cells.
        cells: usize,
        /// A cell where two images disagree.
        cell: usize,
    },
    /// A region with fewer than three corners.
    #[error("a region has {found} corners, but it needs at least 3")]
    RegionCorners {
        /// Number of corners given.
        found: usize,
    },
    /// A corner of a region that is NaN or infinite.
    #[error("corner {corner} of the region is at ({x}, {y})")]
    RegionCorner {
        /// Index of the corner.
        corner: usize,
        /// Its x coordinate.
        x: f64,
        /// Its y coordinate.
        y: f64,
    },
    /// A region whose corners lie on one line.
    #[error("the region has no area")]
    RegionArea,
    /// A region whose border crosses or touches itself.
    #[error("sides {first} and {second} of the region cross or touch each other")]
    RegionCrossing {
        /// The first of the two sides; side k begins at corner k, counted from 0.
        first: usize,
        /// The second.
        second: usize,
    },
    /// More cells than 32-bit indices can address.
    #[error("{cells} cells are more than the {limit} that can be addressed")]
    TooManyCells {
        /// Number of cells given.
        cells: usize,
        /// The largest number possible.
        limit: usize,
    },
}

impl Error {
    /// Advice on what to change, if there is any.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::BoxSide { .. } | Self::BoxOffset { .. } => {
                "give the side lengths of the periodic box in the unit of the positions"
            }
            Self::Grid { .. } => "give the origin and the spacing of the grid in the unit of the positions",
            Self::Position { .. } => {
                "mark absent cells by NaN in both coordinates, and give positions near the origin"
            }
            Self::TooFewCells { .. } => "give more cells, or a periodic box",
            Self::DuplicateCells { .. } => {
                "remove one of the two; in a periodic box two positions may coincide after wrapping, which a box that is \
                 too small causes"
            }
            Self::Collinear { .. } => {
                "cells on a line have no Voronoi polygons; check that x and y are different columns"
            }
            Self::Inconsistent { .. } => {
                "several cells lie on one circle to rounding precision; move them by a tiny random amount"
            }
            Self::RegionCorners { .. } | Self::RegionArea => {
                "give the rectangle [x0, y0, x1, y1] or the corners [[x, y], …] of a polygon"
            }
            Self::RegionCorner { .. } => "corners must be finite numbers",
            Self::RegionCrossing { .. } => {
                "give the corners in the order in which they follow each other around the region"
            }
            Self::TooManyCells { .. } => "split the data",
        })
    }
}
