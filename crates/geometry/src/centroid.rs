//! Where the centroid of a cell's polygon is, seen from the cell.

use crate::{CellPolygon, Scalar, Tessellation, Vector, cross};
use num_dual::DualSVec64;

impl<S: Scalar> CellPolygon<S> {
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
        sum * (self.shape().area * 6.0).recip()
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
    type Dual = DualSVec64<2>;
    let ring: Vec<Vector<f64>> = tessellation.displacements(positions, cell).collect();
    let mut polygon = CellPolygon::default();
    for (seeded, &neighbour) in tessellation.neighbours(cell).iter().enumerate() {
        polygon.fill_ring(ring.iter().enumerate().map(|(m, d)| {
            let (x, y) = (Dual::from_re(d.x), Dual::from_re(d.y));
            if m == seeded { Vector::new(x.derivative(0), y.derivative(1)) } else { Vector::new(x, y) }
        }));
        let at = polygon.centroid();
        let slope = |x: Dual| x.eps.0.map_or([0.0; 2], |eps| [eps[0], eps[1]]);
        let ([xx, xy], [yx, yy]) = (slope(at.x), slope(at.y));
        visit(neighbour as usize, [xx, xy, yx, yy]);
    }
}
