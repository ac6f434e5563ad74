//! One cell: its ring and its Voronoi polygon.

use crate::{Arithmetic, Corner, Scalar, Tessellation, Vector, cross, dot, quarter_turn, side_direction};
use rayon::prelude::*;

/// The size and shape of a cell, as far as forces usually depend on it.
#[derive(Debug, Clone, Copy)]
pub struct Shape<S> {
    /// Area `A = ½ Σ c_{m−1} × c_m`.
    pub area: S,
    /// Perimeter `P = Σ ℓ_m`.
    pub perimeter: S,
}

/// The Voronoi polygon of one cell, in coordinates relative to the cell's centre.
///
/// Vertex `m` is the circumcentre of the cell, its neighbour `m` and its neighbour `m + 1`; side `m` lies between
/// vertex `m − 1` and vertex `m` and faces neighbour `m`. Buffers are kept between cells, so filling one polygon after
/// another does not allocate.
#[derive(Debug, Clone)]
pub struct CellPolygon<S> {
    ring: Vec<Vector<S>>,
    corners: Vec<Corner<S>>,
    directions: Vec<Vector<S>>,
    shape: Shape<S>,
}

impl<S: Arithmetic> Default for CellPolygon<S> {
    fn default() -> Self {
        let zero = S::constant(0.0);
        Self {
            ring: Vec::new(),
            corners: Vec::new(),
            directions: Vec::new(),
            shape: Shape { area: zero, perimeter: zero },
        }
    }
}

impl<S: Scalar> CellPolygon<S> {
    /// Takes the ring of `cell` from a tessellation. The cell must be closed.
    pub fn fill(&mut self, tessellation: &Tessellation, positions: &[Vector<S>], cell: usize) {
        self.fill_ring(tessellation.displacements(positions, cell));
    }
}

impl<S: Arithmetic> CellPolygon<S> {
    /// Takes the positions of the neighbours relative to the cell, counter-clockwise, at least three.
    pub fn fill_ring(&mut self, displacements: impl Iterator<Item = Vector<S>>) {
        self.ring.clear();
        self.ring.extend(displacements);
        self.complete();
    }

    /// A ring of so many neighbours, to be written; [`CellPolygon::complete`] makes the polygon of it.
    #[inline(always)]
    pub fn ring_of(&mut self, sides: usize) -> &mut [Vector<S>] {
        if self.ring.len() != sides {
            let zero = S::constant(0.0);
            self.ring.resize(sides, Vector::new(zero, zero));
        }
        &mut self.ring
    }

    /// The polygon of the ring.
    #[inline(always)]
    pub fn complete(&mut self) {
        let sides = self.ring.len();
        let zero = S::constant(0.0);
        self.shape = Shape { area: zero, perimeter: zero };
        if self.corners.len() != sides {
            let nowhere = Vector::new(zero, zero);
            self.corners.resize(sides, Corner::nowhere());
            self.directions.resize(sides, nowhere);
        }
        // Slices of one length, and loops over indices: what is called must be compiled into the caller, for its processor.
        let ring = &self.ring[..sides];
        let (corners, directions) = (&mut self.corners[..sides], &mut self.directions[..sides]);
        for m in 0..sides {
            corners[m] = Corner::new(ring[m], ring[if m + 1 == sides { 0 } else { m + 1 }]);
            directions[m] = side_direction(ring[m]);
        }
        self.measure();
    }

    #[inline(always)]
    fn measure(&mut self) {
        let sides = self.ring.len();
        let (corners, directions) = (&self.corners[..sides], &self.directions[..sides]);
        let zero = S::constant(0.0);
        let (mut perimeter, mut twice_area) = (zero, zero);
        let Some(last) = corners.last() else { return };
        let mut previous = last.centre;
        for m in 0..sides {
            let c = corners[m].centre;
            twice_area += cross(previous, c);
            perimeter += dot(c - previous, directions[m]);
            previous = c;
        }
        self.shape = Shape { area: twice_area * 0.5, perimeter };
    }

    /// Gives the polygon that has neighbour `m` elsewhere to a function. Only what this neighbour touches is worked out anew, and put back.
    #[inline(always)]
    pub fn with_neighbour(&mut self, m: usize, displacement: Vector<S>, work: impl FnOnce(&Self)) {
        let (before, after) = (self.preceding(m), self.following(m));
        let (ring, direction, shape) = (self.ring[m], self.directions[m], self.shape);
        let corners = [self.corners[before], self.corners[m]];
        self.ring[m] = displacement;
        self.directions[m] = side_direction(displacement);
        self.corners[before] = Corner::new(self.ring[before], displacement);
        self.corners[m] = Corner::new(displacement, self.ring[after]);
        self.measure();
        work(self);
        (self.ring[m], self.directions[m], self.shape) = (ring, direction, shape);
        [self.corners[before], self.corners[m]] = corners;
    }

    /// Number of sides, of vertices and of neighbours.
    pub fn len(&self) -> usize {
        self.ring.len()
    }

    /// Whether the polygon has no side.
    pub fn is_empty(&self) -> bool {
        self.ring.is_empty()
    }

    /// Area and perimeter.
    #[inline(always)]
    pub fn shape(&self) -> Shape<S> {
        self.shape
    }

    /// Neighbours' positions relative to the cell.
    pub fn ring(&self) -> &[Vector<S>] {
        &self.ring
    }

    /// The triangles of the cell with each two consecutive neighbours; their circumcentres are the Voronoi vertices.
    #[inline(always)]
    pub fn corners(&self) -> &[Corner<S>] {
        &self.corners
    }

    /// Voronoi vertices relative to the cell, counter-clockwise.
    pub fn vertices(&self) -> impl Iterator<Item = Vector<S>> + Clone {
        self.corners.iter().map(|corner| corner.centre)
    }

    /// Unit vectors along the sides, counter-clockwise.
    #[inline(always)]
    pub fn directions(&self) -> &[Vector<S>] {
        &self.directions
    }

    /// Signed lengths of the sides: negative only where the topology is not that of the positions.
    pub fn side_lengths(&self) -> impl Iterator<Item = S> {
        let previous = self.corners.iter().cycle().skip(self.len().max(1) - 1);
        (self.corners.iter().zip(previous))
            .zip(&self.directions)
            .map(|((corner, previous), &direction)| dot(corner.centre - previous.centre, direction))
    }

    /// Traceless shape tensor `Q = Σ ℓ t⊗t / P − ½` of the sides, of lengths ℓ along unit vectors t, as `(Q_xx, Q_xy)`: nought of a regular polygon; its
    /// modulus, ½ at most, tells how long the cell is, and half its angle along which axis.
    pub fn shape_tensor(&self) -> [S; 2] {
        let mut sum = [S::constant(0.0); 2];
        for (length, t) in self.side_lengths().zip(&self.directions) {
            sum[0] += length * (t.x * t.x - t.y * t.y) * 0.5;
            sum[1] += length * t.x * t.y;
        }
        let scale = self.shape.perimeter.inverse();
        sum.map(|entry| entry * scale)
    }

    #[inline(always)]
    fn following(&self, m: usize) -> usize {
        if m + 1 == self.len() { 0 } else { m + 1 }
    }

    #[inline(always)]
    fn preceding(&self, m: usize) -> usize {
        if m == 0 { self.len() - 1 } else { m - 1 }
    }

    /// Gradient of the area with respect to vertex `m`: `½ ẑ × (c_{m−1} − c_{m+1})`.
    #[inline(always)]
    pub fn area_gradient(&self, m: usize) -> Vector<S> {
        let (previous, next) = (self.corners[self.preceding(m)], self.corners[self.following(m)]);
        quarter_turn(previous.centre - next.centre) * S::constant(0.5)
    }

    /// Gradient of the perimeter with respect to vertex `m`: `t_m − t_{m+1}` with unit vectors `t` along the sides.
    #[inline(always)]
    pub fn perimeter_gradient(&self, m: usize) -> Vector<S> {
        self.directions[m] - self.directions[self.following(m)]
    }
}

/// A quantity of each closed cell's polygon, and what cells on the hull of an open field have instead.
fn per_cell<T: Copy + Send + Sync>(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    open: T,
    quantity: impl Fn(&CellPolygon<f64>) -> T + Sync,
) -> Vec<T> {
    (0..tessellation.len())
        .into_par_iter()
        .with_min_len(512)
        .map_init(CellPolygon::default, |polygon, cell| {
            if tessellation.is_closed(cell) {
                polygon.fill(tessellation, positions, cell);
                quantity(polygon)
            } else {
                open
            }
        })
        .collect()
}

/// Area of every cell; NaN for cells on the hull of an open field.
pub fn areas(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<f64> {
    per_cell(tessellation, positions, f64::NAN, |polygon| polygon.shape().area)
}

/// Perimeter of every cell; NaN for cells on the hull of an open field.
pub fn perimeters(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<f64> {
    per_cell(tessellation, positions, f64::NAN, |polygon| polygon.shape().perimeter)
}

/// [Shape tensor](CellPolygon::shape_tensor) of every cell; NaN for cells on the hull of an open field.
pub fn shape_tensors(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<[f64; 2]> {
    per_cell(tessellation, positions, [f64::NAN; 2], CellPolygon::shape_tensor)
}

/// Vertices of every cell's polygon, counter-clockwise, around its centre; none of an open one.
pub fn polygons(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<Vec<Vector<f64>>> {
    let mut polygon = CellPolygon::default();
    (0..tessellation.len())
        .map(|cell| {
            if !tessellation.is_closed(cell) {
                return Vec::new();
            }
            polygon.fill(tessellation, positions, cell);
            polygon.vertices().map(|vertex| vertex + positions[cell]).collect()
        })
        .collect()
}
