//! The stress of a tissue and of its cells.

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
    let forces = HalfEdgeForces::of(tessellation, positions, model);
    let mut sum = Sum::default();
    let mut polygon = CellPolygon::default();
    for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell) && counts(cell)) {
        polygon.fill(tessellation, positions, cell);
        sum.add(&forces, tessellation.ring(cell), &polygon);
    }
    sum.stress()
}

/// The same of each cell alone (N): `σ_k = −(1/A_k) Σ_i f_{k,i} ⊗ (r_i − r_k)`, of which the [`stress`] is the mean weighted by areas. NaN of open cells.
pub fn cell_stresses<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    model: &Model<S>,
) -> Vec<[[S; 2]; 2]> {
    let forces = HalfEdgeForces::of(tessellation, positions, model);
    let mut polygon = CellPolygon::default();
    (0..tessellation.len())
        .map(|cell| {
            let mut sum = Sum::default();
            if tessellation.is_closed(cell) {
                polygon.fill(tessellation, positions, cell);
                sum.add(&forces, tessellation.ring(cell), &polygon);
            }
            sum.stress()
        })
        .collect()
}

/// `Σ f ⊗ d` over rings, and the area of their cells.
struct Sum<S> {
    moments: [[S; 2]; 2],
    area: S,
}

impl<S: Scalar> Default for Sum<S> {
    fn default() -> Self {
        let zero = S::constant(0.0);
        Self { moments: [[zero; 2]; 2], area: zero }
    }
}

impl<S: Scalar> Sum<S> {
    fn add(&mut self, forces: &HalfEdgeForces<S>, ring: std::ops::Range<usize>, polygon: &CellPolygon<S>) {
        self.area += polygon.shape().area;
        for (h, d) in ring.zip(polygon.ring()) {
            let f = forces.on_neighbour(h);
            for row in 0..2 {
                for column in 0..2 {
                    self.moments[row][column] += f[row] * d[column];
                }
            }
        }
    }

    fn stress(self) -> [[S; 2]; 2] {
        self.moments.map(|row| row.map(|entry| -entry / self.area))
    }
}
