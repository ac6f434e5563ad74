//! A tension that depends on the number of neighbours.

use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::Scalar;

/// Adhesion in proportion to the number `z` of neighbours beyond six.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoordinationTension;

impl ForceTerm for CoordinationTension {
    fn name(&self) -> &'static str {
        "coordination_tension"
    }

    fn formula(&self) -> &'static str {
        "(z − 6) ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }
}

impl RingTerm for CoordinationTension {
    fn act<S: Scalar>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let polygon = cell.polygon;
        let strength = coefficient * (polygon.len() as f64 - 6.0);
        forces.on_vertices(polygon, |m| polygon.perimeter_gradient(m) * strength);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "coordination_tension",
    formula: "f_v = c (z − 6) ∂P/∂r_v",
    meaning: "Cells with many neighbours have a longer preferred perimeter than cells with few.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(CoordinationTension)]),
};
