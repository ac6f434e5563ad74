//! Centroids were taken for centres.

use super::{Column, Effect, Kind, Unit};
use crate::{BlockMatrix, Exactness, Flow, FlowResponse, Linearisation, Parity, RowAssembly, assemble};
use num_dual::DualSVec64;
use voronudge_geometry::{CellPolygon, Scalar, Vector, cross};

/// The change of the velocities when each centre is moved back from its centroid: `−J (centroid − r)`. Cells with an open polygon
/// are held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CentroidBias;

impl FlowResponse for CentroidBias {
    fn name(&self) -> &'static str {
        "centroid_bias"
    }

    fn formula(&self) -> &'static str {
        "−J (centroid − r)"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        true
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        let mut polygon = CellPolygon::default();
        let offsets: Vec<Vector<S>> = (0..flow.positions.len())
            .map(|cell| match flow.tessellation.is_closed(cell) {
                true => {
                    polygon.fill(flow.tessellation, flow.positions, cell);
                    centroid(&polygon)
                }
                false => Vector::new(S::constant(0.0), S::constant(0.0)),
            })
            .collect();
        let change = flow.along(&offsets);
        flow.each(|cell, _| change[cell] * -coefficient)
    }

    fn linearise(&self, at: &Linearisation<'_>, coefficient: f64) -> BlockMatrix {
        let flow = &at.flow;
        let of_offsets = assemble(flow.positions.len(), |cell, row| {
            if flow.tessellation.is_closed(cell) {
                centroid_row(flow, cell, row);
            }
        });
        assemble(flow.positions.len(), |cell, row| {
            for (j, block) in at.jacobian.row(cell) {
                row.add_row(&block.map(|entry| -coefficient * entry), &of_offsets, j);
            }
        })
    }

    fn exactness(&self) -> Exactness {
        Exactness::FirstOrder
    }
}

/// Centroid of a polygon relative to the cell: `Σ (p + q) (p × q) / (6A)` over the sides from p to q.
fn centroid<S: Scalar>(polygon: &CellPolygon<S>) -> Vector<S> {
    let corners = polygon.corners();
    let zero = S::constant(0.0);
    let mut sum = Vector::new(zero, zero);
    for (m, corner) in corners.iter().enumerate() {
        let next = if m + 1 == corners.len() { 0 } else { m + 1 };
        let (p, q) = (corner.centre, corners[next].centre);
        sum += (p + q) * cross(p, q);
    }
    sum * (polygon.shape().area * 6.0).recip()
}

/// Derivative of a cell's centroid, relative to the cell, by all positions.
fn centroid_row(flow: &Flow<'_, f64>, cell: usize, row: &mut RowAssembly) {
    type Dual = DualSVec64<2>;
    let ring: Vec<Vector<f64>> = flow
        .tessellation
        .ring(cell)
        .map(|h| flow.tessellation.displacement(flow.positions, cell, h))
        .collect();
    let mut polygon = CellPolygon::default();
    for (seeded, &j) in flow.tessellation.neighbours(cell).iter().enumerate() {
        polygon.fill_ring(ring.iter().enumerate().map(|(m, d)| {
            let (x, y) = (Dual::from_re(d.x), Dual::from_re(d.y));
            if m == seeded { Vector::new(x.derivative(0), y.derivative(1)) } else { Vector::new(x, y) }
        }));
        let at = centroid(&polygon);
        let slope = |x: Dual| x.eps.0.map_or([0.0; 2], |eps| [eps[0], eps[1]]);
        let ([xx, xy], [yx, yy]) = (slope(at.x), slope(at.y));
        row.add(j as usize, &[xx, xy, yx, yy]);
        row.add(cell, &[-xx, -xy, -yx, -yy]);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "centroid_bias",
    formula: "v = v₀ − c J (centroid − r)",
    meaning: "Segmentation gave centroids of cells where the model asks for centres (c = 1: all the way).",
    kind: Kind::Observation,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: 0 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(CentroidBias)]),
};
