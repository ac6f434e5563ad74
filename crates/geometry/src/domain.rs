//! Where cells live: a periodic box (also sheared, for Lees–Edwards boundaries) or an open field of view.

use crate::{Error, Scalar, Vector};
use std::ops::RangeInclusive;

/// The boundary condition. All of geometry, mechanics and inference see boundaries through this type only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain {
    /// Copies of the cells fill the plane.
    Periodic(PeriodicBox),
    /// The plane, of which a part was seen: cells at the rim of the data have no closed polygon.
    Open,
}

/// A periodic box with lattice vectors `(L_x, 0)` and `(offset, L_y)`.
///
/// A non-zero offset is the Lees–Edwards boundary of simple shear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodicBox {
    lengths: [f64; 2],
    offset: f64,
}

/// Sides whose squares and products are numbers of full precision.
const SIDES: RangeInclusive<f64> = 1e-100..=1e100;

/// Largest shear of a box, in its widths: the offset is then known to 10⁻⁷ widths.
const MOST_WIDTHS: f64 = 1e9;

/// Largest distance of a position from the origin, in boxes: images are counted in 16 bits.
pub(crate) const MOST_BOXES: f64 = 8192.0;

/// Widths of the box that its shear, and cells along it, may run on. Images of cells that went up a few boxes stay countable until the next offset is taken.
const RUNNING_ON: f64 = 0.25 * MOST_BOXES;

impl PeriodicBox {
    /// A rectangular box with sides `[L_x, L_y]`.
    ///
    /// # Errors
    /// [`Error::BoxSide`] if a side is not positive and finite.
    pub fn new(lengths: [f64; 2]) -> Result<Self, Error> {
        Self::sheared(lengths, 0.0)
    }

    /// A box whose upper neighbour image is displaced by `offset` along x.
    ///
    /// # Errors
    /// [`Error::BoxSide`] or [`Error::BoxOffset`] if a number is not usable.
    pub fn sheared(lengths: [f64; 2], offset: f64) -> Result<Self, Error> {
        for (axis, length) in ['x', 'y'].into_iter().zip(lengths) {
            if !SIDES.contains(&length) {
                return Err(Error::BoxSide { axis, length });
            }
        }
        let limit = MOST_BOXES * lengths[0];
        if !offset.is_finite() || offset.abs() > limit {
            return Err(Error::BoxOffset { offset, limit });
        }
        Ok(Self { lengths, offset })
    }

    /// The same box after a simple shear by `strain`. Beyond 4096 widths its offset is less by a multiple of as many, which makes the
    /// same lattice.
    ///
    /// # Errors
    /// [`Error::BoxOffset`] if the strain is not finite or moves the box by more widths than an offset can resolve.
    pub fn after_shear(&self, strain: f64) -> Result<Self, Error> {
        let offset = self.sheared_to(strain);
        let limit = MOST_WIDTHS * self.lengths[0];
        // NaN is no offset either.
        if !offset.is_finite() || offset.abs() > limit {
            return Err(Error::BoxOffset { offset, limit });
        }
        Self::sheared(self.lengths, offset % (0.5 * MOST_BOXES * self.lengths[0]))
    }

    /// Whether cells may run on across the boundary of this box while it is sheared by `strain`: up to 2048 widths. Beyond they have to be
    /// put back into the box, or their images were more than can be counted.
    pub fn runs_on(&self, strain: f64) -> bool {
        self.sheared_to(strain).abs() <= RUNNING_ON * self.lengths[0]
    }

    /// Where a cell goes on from that must not run on: in the box if it is above, below, or very far beside it, else where it is.
    pub fn brought_back(&self, r: Vector<f64>) -> Vector<f64> {
        let [column, row] = self.image(r);
        // Along the shear cells are carried anyway.
        if row == 0 && f64::from(column).abs() <= RUNNING_ON { r } else { self.wrap(r) }
    }

    fn sheared_to(&self, strain: f64) -> f64 {
        self.offset + strain * self.lengths[1]
    }

    /// Side lengths `[L_x, L_y]`.
    pub fn lengths(&self) -> [f64; 2] {
        self.lengths
    }

    /// Displacement along x of the image one box above.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Area of the box.
    pub fn area(&self) -> f64 {
        self.lengths[0] * self.lengths[1]
    }

    /// Translation by `n` lattice vectors.
    #[inline]
    pub fn translation(&self, n: [i32; 2]) -> Vector<f64> {
        let [nx, ny] = [f64::from(n[0]), f64::from(n[1])];
        Vector::new(nx * self.lengths[0] + ny * self.offset, ny * self.lengths[1])
    }

    /// Lattice translation `n` such that `r − translation(n)` lies in the rectangle `[0, L_x) × [0, L_y)`.
    pub fn image(&self, r: Vector<f64>) -> [i32; 2] {
        let ny = (r.y / self.lengths[1]).floor();
        let nx = ((r.x - ny * self.offset) / self.lengths[0]).floor();
        [nx as i32, ny as i32]
    }

    /// The image of `r` in the rectangle `[0, L_x) × [0, L_y)`.
    pub fn wrap(&self, r: Vector<f64>) -> Vector<f64> {
        r - self.translation(self.image(r))
    }

    /// The shortest image of a displacement, for displacements well below half the box.
    pub fn shortest(&self, d: Vector<f64>) -> Vector<f64> {
        let ny = (d.y / self.lengths[1]).round();
        let nx = ((d.x - ny * self.offset) / self.lengths[0]).round();
        d - self.translation([nx as i32, ny as i32])
    }
}

impl Domain {
    /// Displacement from cell `from` to the image of cell `to` that is `image` lattice vectors away.
    #[inline]
    pub fn displacement<S: Scalar>(&self, from: Vector<S>, to: Vector<S>, image: [i16; 2]) -> Vector<S> {
        let d = to - from;
        match self {
            Self::Periodic(cell) if image != [0, 0] => {
                let t = cell.translation([i32::from(image[0]), i32::from(image[1])]);
                Vector::new(d.x + t.x, d.y + t.y)
            }
            _ => d,
        }
    }

    /// The image of a place in the box; in the open plane, the place itself.
    pub fn wrap(&self, r: Vector<f64>) -> Vector<f64> {
        match self {
            Self::Periodic(cell) => cell.wrap(r),
            Self::Open => r,
        }
    }

    /// The shortest displacement equivalent to `d`.
    pub fn shortest(&self, d: Vector<f64>) -> Vector<f64> {
        match self {
            Self::Periodic(cell) => cell.shortest(d),
            Self::Open => d,
        }
    }
}
