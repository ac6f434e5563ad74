//! Uniform growth or spreading of an open tissue.

use super::{Column, Effect, Kind, Unit, open_only};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::Elementary;

/// Uniform dilation about the origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Expansion;

impl ForceTerm for Expansion {
    fn name(&self) -> &'static str {
        "expansion"
    }

    fn formula(&self) -> &'static str {
        "x"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for Expansion {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        forces.on_cell(cell.from_origin() * coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "expansion",
    formula: "v = c x",
    meaning: "The tissue spreads outwards (or contracts) at a uniform rate.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, domain| {
        open_only(domain)?;
        Ok(vec![Column::from(Expansion)])
    },
};
