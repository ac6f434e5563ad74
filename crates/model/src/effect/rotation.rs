//! Rigid rotation of an open tissue.

use super::{Column, Effect, Kind, Unit, open_only};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// Rigid rotation about the origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rotation;

impl ForceTerm for Rotation {
    fn name(&self) -> &'static str {
        "rotation"
    }

    fn formula(&self) -> &'static str {
        "ẑ × x"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for Rotation {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        forces.on_cell(quarter_turn(cell.from_origin()) * coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "rotation",
    formula: "v = c ẑ × x",
    meaning: "The whole tissue turns like a rigid body.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, domain| {
        open_only(domain)?;
        Ok(vec![Column::from(Rotation)])
    },
};
