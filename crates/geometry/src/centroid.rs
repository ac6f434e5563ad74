//! Where the centroid of a cell's polygon is, seen from the cell.

use crate::{Arithmetic, CellPolygon, Tangent, Tessellation, Vector, cross};

impl<S: Arithmetic> CellPolygon<S> {
    /// Centroid relative to the cell: `Σ (p + q) (p × q) / (6A)` over the sides from p to q.
    pub fn centroid(&self) -> Vector<S> {
        let corners = self.corners();
        let zero = S::constant(0.0);
        let mut sum = Vector::new(zero, zero);
        for (m, corner) in corners.iter().enumerate() {
            let next = if m + 1 == corners.len() { 0 } else { m + 1 };
            let (p, q) = (corner.centre, corners[next].centre);
            sum += (p + q) * cross(p, q);
        }
        sum * (self.shape().area * 6.0).inverse()
    }
}

/// The derivative of a closed cell's centroid, relative to the cell, by the positions of its neighbours: visits each with the
/// blocks (xx, xy, yx, yy). That by the cell's own position is minus their sum.
pub fn centroid_slopes(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    cell: usize,
    mut visit: impl FnMut(usize, [f64; 4]),
) {
    type Dual = Tangent<f64, 2>;
    let ring = || tessellation.displacements(positions, cell);
    let mut polygon = CellPolygon::default();
    polygon.fill_ring(ring().map(Dual::held_vector));
    for ((m, d), &neighbour) in ring().enumerate().zip(tessellation.neighbours(cell)) {
        polygon.with_neighbour(m, Dual::seeded_vector(d), |polygon| {
            visit(neighbour as usize, Dual::block(&polygon.centroid()));
        });
    }
}
