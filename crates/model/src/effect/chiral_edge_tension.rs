//! Chirality of single junctions.

use super::edge_tension::each_side_gradient;
use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// The tension of the sides of [`EdgeTension`](super::EdgeTension), turned by a quarter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChiralEdgeTension;

impl ForceTerm for ChiralEdgeTension {
    fn name(&self) -> &'static str {
        "chiral_edge_tension"
    }

    fn formula(&self) -> &'static str {
        "ẑ × ∂(½ Σ ℓ²)/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl RingTerm for ChiralEdgeTension {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        each_side_gradient(cell, |m, gradient| {
            forces.on_vertex(cell.polygon, m, quarter_turn(gradient) * coefficient);
        });
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "chiral_edge_tension",
    formula: "f_v = c ẑ × ∂(½ Σ ℓ²)/∂r_v",
    meaning: "Each junction turns its ends, the more the longer it is.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 0, time: -1 },
    aliases: &[Alias {
        of: "alpha",
        told_apart_by: "junctions of very different length within a cell, or laser cuts of single junctions",
    }],
    columns: |_, _| Ok(vec![Column::from(ChiralEdgeTension)]),
};
