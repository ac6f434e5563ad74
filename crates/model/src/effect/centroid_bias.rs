//! Centroids were taken for centres.

use super::{Column, Effect, Kind, Unit};
use crate::{Exactness, Flow, FlowResponse, Linearisation, Parity, RowAssembly, Rows, assemble};
use voronudge_geometry::{CellPolygon, Scalar, Vector, centroid_slopes};

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
                    polygon.centroid()
                }
                false => Vector::new(S::constant(0.0), S::constant(0.0)),
            })
            .collect();
        let change = flow.along(&offsets);
        flow.each(|cell, _| change[cell] * -coefficient)
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let flow = &at.flow;
        let of_offsets = assemble(flow.positions.len(), |cell, row| {
            if flow.tessellation.is_closed(cell) {
                centroid_row(flow, cell, row);
            }
        });
        Box::new(move |cell, row| {
            for (j, block) in at.jacobian.row(cell) {
                row.add_row(&block.map(|entry| -coefficient * entry), &of_offsets, j);
            }
        })
    }

    fn exactness(&self) -> Exactness {
        Exactness::FirstOrder
    }
}

/// Derivative of a cell's centroid, relative to the cell, by all positions.
fn centroid_row(flow: &Flow<'_, f64>, cell: usize, row: &mut RowAssembly) {
    centroid_slopes(flow.tessellation, flow.positions, cell, |neighbour, block| {
        row.add(neighbour, &block);
        row.add(cell, &block.map(|slope| -slope));
    });
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
