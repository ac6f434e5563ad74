//! A regular grid of rectangles in the plane.

use crate::{Domain, Error, Vector};

/// Squares (rectangles, if the spacings differ) centred at `origin + (ix · dx, iy · dy)`.
///
/// The square (ix, iy) has the index `iy · nx + ix`. The grid is a part of the plane, not of a periodic box: it may
/// straddle the boundary of the box, and cover a part of it several times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    origin: [f64; 2],
    spacing: [f64; 2],
    size: [usize; 2],
}

impl Grid {
    /// A grid of `size` = [nx, ny] squares, the first of which is centred at `origin`, in the unit of the positions.
    ///
    /// # Errors
    /// [`Error::Grid`] if the origin is not finite or a spacing not positive.
    ///
    /// ```
    /// use voronudge_geometry::{Grid, Vector};
    /// let grid = Grid::new([0.5, 0.5], [1.0, 1.0], [4, 3])?;
    /// assert_eq!(grid.len(), 12);
    /// assert_eq!(grid.centre(5), Vector::new(1.5, 1.5));
    /// assert!(Grid::new([0.5, 0.5], [1.0, 0.0], [4, 3]).is_err());
    /// # Ok::<(), voronudge_geometry::Error>(())
    /// ```
    pub fn new(origin: [f64; 2], spacing: [f64; 2], size: [usize; 2]) -> Result<Self, Error> {
        for (axis, (origin, spacing)) in ['x', 'y'].into_iter().zip(origin.into_iter().zip(spacing)) {
            if !(origin.is_finite() && spacing.is_finite() && spacing > 0.0) {
                return Err(Error::Grid { axis, origin, spacing });
            }
        }
        Ok(Self { origin, spacing, size })
    }

    /// Number of squares along each axis, [nx, ny].
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Distances between the centres of squares, [dx, dy].
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Number of squares.
    pub fn len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Whether there is no square.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Area of a square.
    pub fn square_area(&self) -> f64 {
        self.spacing[0] * self.spacing[1]
    }

    /// Centre of a square.
    pub fn centre(&self, square: usize) -> Vector<f64> {
        let [ix, iy] = [square % self.size[0], square / self.size[0]];
        Vector::new(
            self.origin[0] + ix as f64 * self.spacing[0],
            self.origin[1] + iy as f64 * self.spacing[1],
        )
    }

    pub(crate) fn index(&self, [ix, iy]: [usize; 2]) -> usize {
        iy * self.size[0] + ix
    }

    /// Visits the images of something at `at`, between `low` and `high` relative to it, that may touch the grid.
    pub(crate) fn for_images(
        &self,
        domain: Domain,
        at: Vector<f64>,
        [low, high]: [Vector<f64>; 2],
        mut visit: impl FnMut(Lines<'_>),
    ) {
        let corner = Vector::from(self.origin) - Vector::from(self.spacing) * 0.5 - at;
        let Domain::Periodic(cell) = domain else {
            return visit(Lines { grid: self, corner });
        };
        let far = corner
            + Vector::new(self.size[0] as f64 * self.spacing[0], self.size[1] as f64 * self.spacing[1]);
        let lengths = cell.lengths();
        let between = |axis: usize, shift: f64| {
            let first = ((corner[axis] - high[axis] - shift) / lengths[axis]).ceil();
            let last = ((far[axis] - low[axis] - shift) / lengths[axis]).floor();
            first as i32..=last as i32
        };
        for ny in between(1, 0.0) {
            for nx in between(0, f64::from(ny) * cell.offset()) {
                visit(Lines { grid: self, corner: corner - cell.translation([nx, ny]) });
            }
        }
    }
}

/// The lines of a grid in coordinates relative to a point.
pub(crate) struct Lines<'a> {
    grid: &'a Grid,
    /// Lower left corner of the first square.
    corner: Vector<f64>,
}

impl Lines<'_> {
    pub fn grid(&self) -> &Grid {
        self.grid
    }

    /// Lower end of the squares with a given number along an axis; upper end of those before.
    pub fn line(&self, axis: usize, number: usize) -> f64 {
        self.corner[axis] + number as f64 * self.grid.spacing[axis]
    }

    /// Number along an axis of the squares that hold a coordinate: −1 before the grid, at most n behind it.
    pub fn number(&self, axis: usize, coordinate: f64) -> isize {
        let number = ((coordinate - self.corner[axis]) / self.grid.spacing[axis]).floor();
        (number as isize).clamp(-1, self.grid.size[axis] as isize)
    }

    /// Numbers along an axis of the squares that meet an interval.
    pub fn numbers(&self, axis: usize, [low, high]: [f64; 2]) -> std::ops::Range<usize> {
        let first = self.number(axis, low).max(0) as usize;
        let end = (self.number(axis, high) + 1).max(0) as usize;
        first..end.min(self.grid.size[axis])
    }
}
