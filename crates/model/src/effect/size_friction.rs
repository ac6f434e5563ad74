//! Mobility that depends on the size of the cell.

use super::{Column, Effect, Kind, Unit};
use crate::{Flow, FlowResponse, Linearisation, Parity, Rows};
use voronudge_geometry::{CellPolygon, Scalar, Vector};

/// Velocities in proportion to the area of the cell beyond the mean `ℓ_0²`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SizeFriction;

impl FlowResponse for SizeFriction {
    fn name(&self) -> &'static str {
        "size_friction"
    }

    fn formula(&self) -> &'static str {
        "(A/ℓ_0² − 1) v₀"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        let scale = flow.model.environment.cell_size().powi(-2);
        let mut polygon = CellPolygon::default();
        flow.each(|cell, v| {
            if !flow.moves(cell) {
                return v;
            }
            polygon.fill(flow.tessellation, flow.positions, cell);
            v * ((polygon.shape().area * scale - 1.0) * coefficient)
        })
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let Linearisation { flow, jacobian } = at;
        Box::new(move |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            let scale = flow.model.environment.cell_size().powi(-2);
            let mut polygon = CellPolygon::default();
            polygon.fill(flow.tessellation, flow.positions, cell);
            row.add_scaled_row(coefficient * (polygon.shape().area * scale - 1.0), jacobian, cell);
            let v = flow.velocities[cell] * (coefficient * scale);
            let sides = polygon.len();
            for (m, corner) in polygon.corners().iter().enumerate() {
                let gradients = corner.pull_back(polygon.area_gradient(m));
                for (g, side) in gradients.iter().zip([m, (m + 1) % sides]) {
                    let block = [v.x * g.x, v.x * g.y, v.y * g.x, v.y * g.y];
                    row.add(flow.tessellation.neighbours(cell)[side] as usize, &block);
                    row.add(cell, &block.map(|entry| -entry));
                }
            }
        })
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "size_friction",
    formula: "v = v₀ + c (A/ℓ_0² − 1) v₀",
    meaning: "Large cells move more easily (c > 0) or less than small ones: their friction does not grow in step with their area.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: 0 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(SizeFriction)]),
};
