//! One cell: its ring, its polygon, and the maps between vertices and centres.

use crate::{Scalar, Tessellation, Vector, circumcentre, cross, dot, quarter_turn};
use rayon::prelude::*;

/// The Voronoi polygon of one cell, in coordinates relative to the cell's centre.
///
/// Vertex `m` is the circumcentre of the cell, its neighbour `m` and its neighbour `m + 1`; side `m` lies between
/// vertex `m − 1` and vertex `m` and faces neighbour `m`. Buffers are kept between cells, so filling one polygon after
/// another does not allocate.
#[derive(Debug, Clone)]
pub struct CellPolygon<S> {
    ring: Vec<Vector<S>>,
    vertices: Vec<Vector<S>>,
    /// 1 / (d_m × d_{m+1})
    inverse_cross: Vec<S>,
    tangents: Vec<Vector<S>>,
    lengths: Vec<S>,
    area: S,
    perimeter: S,
}

impl<S: Scalar> Default for CellPolygon<S> {
    fn default() -> Self {
        Self {
            ring: Vec::new(),
            vertices: Vec::new(),
            inverse_cross: Vec::new(),
            tangents: Vec::new(),
            lengths: Vec::new(),
            area: S::constant(0.0),
            perimeter: S::constant(0.0),
        }
    }
}

impl<S: Scalar> CellPolygon<S> {
    /// Takes the ring of `cell` from a tessellation. The cell must be closed.
    pub fn fill(&mut self, tessellation: &Tessellation, positions: &[Vector<S>], cell: usize) {
        self.fill_ring(tessellation.ring(cell).map(|h| tessellation.displacement(positions, cell, h)));
    }

    /// Takes the positions of the neighbours relative to the cell, counter-clockwise.
    pub fn fill_ring(&mut self, displacements: impl Iterator<Item = Vector<S>>) {
        self.ring.clear();
        self.ring.extend(displacements);
        let sides = self.ring.len();
        self.vertices.clear();
        self.inverse_cross.clear();
        self.tangents.clear();
        self.lengths.clear();
        for m in 0..sides {
            let (a, b) = (self.ring[m], self.ring[if m + 1 == sides { 0 } else { m + 1 }]);
            self.inverse_cross.push(cross(a, b).recip());
            self.vertices.push(circumcentre(a, b));
        }
        let (mut perimeter, mut twice_area) = (S::constant(0.0), S::constant(0.0));
        for m in 0..sides {
            let (c, previous) = (self.vertices[m], self.vertices[if m == 0 { sides - 1 } else { m - 1 }]);
            // The side is perpendicular to the line between the centres. Its direction from the centres, and its length
            // as a projection, stay smooth where the side shrinks to zero.
            let tangent = quarter_turn(self.ring[m]) * dot(self.ring[m], self.ring[m]).sqrt().recip();
            let length = dot(c - previous, tangent);
            twice_area += cross(previous, c);
            perimeter += length;
            self.tangents.push(tangent);
            self.lengths.push(length);
        }
        self.perimeter = perimeter;
        self.area = twice_area * 0.5;
    }

    /// Number of sides, of vertices and of neighbours.
    pub fn len(&self) -> usize {
        self.ring.len()
    }

    /// Whether the polygon has no side.
    pub fn is_empty(&self) -> bool {
        self.ring.is_empty()
    }

    /// Area `A = ½ Σ c_{m−1} × c_m`.
    pub fn area(&self) -> S {
        self.area
    }

    /// Perimeter `P = Σ ℓ_m`.
    pub fn perimeter(&self) -> S {
        self.perimeter
    }

    /// Neighbours' positions relative to the cell.
    pub fn ring(&self) -> &[Vector<S>] {
        &self.ring
    }

    /// Voronoi vertices relative to the cell.
    pub fn vertices(&self) -> &[Vector<S>] {
        &self.vertices
    }

    /// Signed lengths of the sides: negative only where the topology is not that of the positions.
    pub fn side_lengths(&self) -> &[S] {
        &self.lengths
    }

    /// Unit vectors along the sides, counter-clockwise.
    pub fn tangents(&self) -> &[Vector<S>] {
        &self.tangents
    }

    fn following(&self, m: usize) -> usize {
        if m + 1 == self.len() { 0 } else { m + 1 }
    }

    /// Gradient of the area with respect to vertex `m`: `−½ ẑ × (c_{m+1} − c_{m−1})`.
    #[inline]
    pub fn area_gradient(&self, m: usize) -> Vector<S> {
        let previous = self.vertices[if m == 0 { self.len() - 1 } else { m - 1 }];
        quarter_turn(previous - self.vertices[self.following(m)]) * S::constant(0.5)
    }

    /// Gradient of the perimeter with respect to vertex `m`: `t_m − t_{m+1}`.
    #[inline]
    pub fn perimeter_gradient(&self, m: usize) -> Vector<S> {
        self.tangents[m] - self.tangents[self.following(m)]
    }

    /// Forces on the neighbours that a force `f` on vertex `m` transmits: `fᵀ ∂c/∂r` for neighbours `m` and `m + 1`.
    ///
    /// Differentiating `a·c = a²/2`, `b·c = b²/2` gives `∂c/∂a = −(ẑ×b)/(a×b) ⊗ (a − c)` and
    /// `∂c/∂b = (ẑ×a)/(a×b) ⊗ (b − c)`. The rest of `f` acts on the cell itself.
    #[inline]
    pub fn transmit(&self, m: usize, f: Vector<S>) -> [Vector<S>; 2] {
        let (a, b, c) = (self.ring[m], self.ring[self.following(m)], self.vertices[m]);
        let s = self.inverse_cross[m];
        [(a - c) * (cross(f, b) * s), (b - c) * (cross(a, f) * s)]
    }
}

/// A quantity of each closed cell's polygon; NaN for cells on the hull of an open field.
fn per_cell(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    quantity: impl Fn(&CellPolygon<f64>) -> f64 + Sync,
) -> Vec<f64> {
    (0..tessellation.len())
        .into_par_iter()
        .with_min_len(512)
        .map_init(CellPolygon::default, |polygon, cell| {
            if tessellation.is_closed(cell) {
                polygon.fill(tessellation, positions, cell);
                quantity(polygon)
            } else {
                f64::NAN
            }
        })
        .collect()
}

/// Area of every cell; NaN for cells on the hull of an open field.
pub fn areas(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<f64> {
    per_cell(tessellation, positions, CellPolygon::area)
}

/// Perimeter of every cell; NaN for cells on the hull of an open field.
pub fn perimeters(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<f64> {
    per_cell(tessellation, positions, CellPolygon::perimeter)
}
