//! Motion along the free edge.

use super::boundary_tension::{needs_edge, outward};
use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// A force on counted cells along the edge, across the normal of [`BoundaryTension`](super::BoundaryTension).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoundaryTorque;

impl ForceTerm for BoundaryTorque {
    fn name(&self) -> &'static str {
        "boundary_torque"
    }

    fn formula(&self) -> &'static str {
        "−ẑ × n"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for BoundaryTorque {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        forces.on_cell(-quarter_turn(outward(cell)) * coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "boundary_torque",
    formula: "v = −c ẑ × n at the edge",
    meaning: "Cells at the free edge move along it, all around in the same sense.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[Alias {
        of: "rotation",
        told_apart_by: "a larger piece of tissue: rotation grows towards the edge, the torque acts at the edge only",
    }],
    columns: |environment, domain| {
        needs_edge(environment, domain)?;
        Ok(vec![Column::from(BoundaryTorque)])
    },
};
