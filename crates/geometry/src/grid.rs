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
    patch: Patch,
}

/// The part of the plane around a centre, with a weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Patch {
    /// A square, or a rectangle whose sides are in the ratio of the spacings, with the area of a square of some side; weight 1.
    Square(f64),
    /// All of the plane, with the weight `exp(−d²/2s²)` at the distance d; s is given.
    Gaussian(f64),
}

/// Distance at which Gaussian patches end, in standard deviations; the weight there is 4e-6.
const REACH: f64 = 5.0;

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
        let patch = Patch::Square((spacing[0] * spacing[1]).sqrt());
        Ok(Self { origin, spacing, size, patch })
    }

    /// The same centres with patches of another shape; by default squares that touch.
    #[must_use]
    pub fn with_patch(self, patch: Patch) -> Self {
        Self { patch, ..self }
    }

    /// What is around each centre.
    pub fn patch(&self) -> Patch {
        self.patch
    }

    /// Area of a patch, weighted.
    pub fn patch_area(&self) -> f64 {
        match self.patch {
            Patch::Square(side) => side * side,
            Patch::Gaussian(width) => std::f64::consts::TAU * width * width,
        }
    }

    /// Sides of a square patch of side one.
    pub(crate) fn aspect(&self) -> [f64; 2] {
        let [dx, dy] = self.spacing;
        [(dx / dy).sqrt(), (dy / dx).sqrt()]
    }

    /// Distance along each axis from a centre to the end of its patch.
    fn reach(&self) -> [f64; 2] {
        match self.patch {
            Patch::Square(side) => self.aspect().map(|part| 0.5 * side * part),
            Patch::Gaussian(width) => [REACH * width; 2],
        }
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

    /// Visits the centres of squares within `radius` of a point or of its images: the square, and the displacement from
    /// the image to the centre.
    pub fn for_centres_near(
        &self,
        domain: Domain,
        at: Vector<f64>,
        radius: f64,
        mut visit: impl FnMut(usize, Vector<f64>),
    ) {
        let reach = Vector::new(radius, radius);
        self.for_images(domain, at, [-reach, reach], |centres| {
            centres.near([-reach, reach], |square, displacement| {
                if displacement.norm_squared() <= radius * radius {
                    visit(square, displacement);
                }
            });
        });
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
        mut visit: impl FnMut(Centres<'_>),
    ) {
        let first = Vector::from(self.origin) - at;
        let Domain::Periodic(cell) = domain else {
            return visit(Centres { grid: self, first });
        };
        let (lengths, reach) = (cell.lengths(), self.reach());
        let between = |axis: usize, shift: f64| {
            let last = first[axis] + (self.size[axis] as f64 - 1.0) * self.spacing[axis];
            let below = (first[axis] - reach[axis] - high[axis] - shift) / lengths[axis];
            let above = (last + reach[axis] - low[axis] - shift) / lengths[axis];
            below.ceil() as i32..=above.floor() as i32
        };
        for ny in between(1, 0.0) {
            for nx in between(0, f64::from(ny) * cell.offset()) {
                visit(Centres { grid: self, first: first - cell.translation([nx, ny]) });
            }
        }
    }
}

/// The centres of a grid in coordinates relative to a point.
pub(crate) struct Centres<'a> {
    grid: &'a Grid,
    first: Vector<f64>,
}

impl Centres<'_> {
    pub fn grid(&self) -> &Grid {
        self.grid
    }

    /// Coordinate along an axis of the centres with a given number.
    pub fn centre(&self, axis: usize, number: usize) -> f64 {
        self.first[axis] + number as f64 * self.grid.spacing[axis]
    }

    /// Both ends along an axis of the patches with a given number.
    pub fn ends(&self, axis: usize, number: usize) -> [f64; 2] {
        let (centre, reach) = (self.centre(axis, number), self.grid.reach()[axis]);
        [centre - reach, centre + reach]
    }

    /// Numbers along an axis of the patches that meet an interval.
    pub fn numbers(&self, axis: usize, [low, high]: [f64; 2]) -> std::ops::Range<usize> {
        let reach = self.grid.reach()[axis];
        self.between(axis, [low - reach, high + reach])
    }

    /// Numbers along an axis of the centres in an interval.
    fn between(&self, axis: usize, [low, high]: [f64; 2]) -> std::ops::Range<usize> {
        let number = |coordinate: f64| (coordinate - self.first[axis]) / self.grid.spacing[axis];
        let (first, last) = (number(low).ceil().max(0.0), number(high).floor() + 1.0);
        first as usize..(last.max(0.0) as usize).min(self.grid.size[axis])
    }

    /// Visits the centres in a rectangle: index and place.
    fn near(&self, [low, high]: [Vector<f64>; 2], visit: impl FnMut(usize, Vector<f64>)) {
        self.each([0, 1].map(|axis| self.between(axis, [low[axis], high[axis]])), visit);
    }

    /// Visits the centres whose patches meet a rectangle.
    pub fn meeting(&self, [low, high]: [Vector<f64>; 2], visit: impl FnMut(usize, Vector<f64>)) {
        self.each([0, 1].map(|axis| self.numbers(axis, [low[axis], high[axis]])), visit);
    }

    fn each(&self, [xs, ys]: [std::ops::Range<usize>; 2], mut visit: impl FnMut(usize, Vector<f64>)) {
        for iy in ys {
            for ix in xs.clone() {
                visit(self.grid.index([ix, iy]), Vector::new(self.centre(0, ix), self.centre(1, iy)));
            }
        }
    }
}
