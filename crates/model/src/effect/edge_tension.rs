//! Tension of single junctions.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Scalar, Vector};

/// A tension of each side that grows with its length: the energy `½ Σ ℓ²` of the sides of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgeTension;

impl ForceTerm for EdgeTension {
    fn name(&self) -> &'static str {
        "edge_tension"
    }

    fn formula(&self) -> &'static str {
        "−∂(½ Σ ℓ²)/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }
}

impl RingTerm for EdgeTension {
    fn act<S: Scalar>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        forces.on_vertices(cell.polygon, |m| -side_gradient(cell, m) * coefficient);
    }
}

/// `∂(½ Σ ℓ²)/∂r_v` at vertex `m`, between the sides `m` and `m + 1`.
pub(super) fn side_gradient<S: Scalar>(cell: &CellElement<'_, S>, m: usize) -> Vector<S> {
    let next = if m + 1 == cell.neighbours.len() { 0 } else { m + 1 };
    let ((before, t_before), (after, t_after)) = (cell.side(m), cell.side(next));
    t_before * before - t_after * after
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "edge_tension",
    formula: "f_v = −c ∂(½ Σ ℓ²)/∂r_v",
    meaning: "Each cell junction pulls with a tension that grows with its length.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: -1 },
    aliases: &[Alias {
        of: "adhesion",
        told_apart_by: "junctions of very different length within a cell, or laser cuts of single junctions",
    }],
    columns: |_, _| Ok(vec![Column::from(EdgeTension)]),
};
