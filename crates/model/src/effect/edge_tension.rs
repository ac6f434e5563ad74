//! Tension of single junctions.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

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
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        each_side_gradient(cell, |m, gradient| forces.on_vertex(cell.polygon, m, -gradient * coefficient));
    }
}

/// `∂(½ Σ ℓ²)/∂r_v` at each vertex, between the sides `m` and `m + 1`.
pub(super) fn each_side_gradient<S: Elementary>(
    cell: &CellElement<'_, S>,
    mut give: impl FnMut(usize, Vector<S>),
) {
    let sides = cell.polygon.len();
    let pull = |m: usize| {
        let (length, direction) = cell.side(m);
        direction * length
    };
    let first = pull(0);
    let mut before = first;
    for m in 0..sides {
        let after = if m + 1 == sides { first } else { pull(m + 1) };
        give(m, before - after);
        before = after;
    }
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
