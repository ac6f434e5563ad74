//! The mean stress of a tissue.

use crate::{HalfEdgeForces, Model};
use voronudge_geometry::{CellPolygon, Scalar, Tessellation, Vector};

/// Mean stress `σ = −(1/S) Σ_k Σ_i f_{k,i} ⊗ (r_i − r_k)`, row = component of the force, in units of rate (friction
/// is absorbed).
///
/// `S` is the total area of the cells summed over: all in a periodic box, those with a closed polygon and `counts`
/// otherwise.
pub fn stress<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    model: &Model<S>,
    counts: impl Fn(usize) -> bool,
) -> [[S; 2]; 2] {
    let mut forces = HalfEdgeForces::default();
    forces.evaluate(tessellation, positions, model, &mut Vec::new());
    let zero = S::constant(0.0);
    let (mut sum, mut area) = ([[zero; 2]; 2], zero);
    let mut polygon = CellPolygon::default();
    for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell) && counts(cell)) {
        polygon.fill(tessellation, positions, cell);
        area += polygon.shape().area;
        for (h, d) in tessellation.ring(cell).zip(polygon.ring()) {
            let f = forces.on_neighbour(h);
            for row in 0..2 {
                for column in 0..2 {
                    sum[row][column] += f[row] * d[column];
                }
            }
        }
    }
    sum.map(|row| row.map(|entry| -entry / area))
}
