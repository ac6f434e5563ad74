//! Stress along the long axis of a cell.

use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

/// The stress `ζ Q` within the cell, with `Q` the traceless shape tensor of its sides, divided by the perimeter. A vertex feels
/// `−σ ∂A/∂r_v`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NematicStress;

impl ForceTerm for NematicStress {
    fn name(&self) -> &'static str {
        "nematic_stress"
    }

    fn formula(&self) -> &'static str {
        "−Q ∂A/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }
}

impl RingTerm for NematicStress {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let polygon = cell.polygon;
        let [xx, xy] = polygon.shape_tensor();
        let stress = [xx * coefficient, xy * coefficient];
        forces.on_vertices(polygon, |m| -contract(stress, polygon.area_gradient(m)));
    }
}

/// `Q g` for a traceless symmetric tensor.
pub(super) fn contract<S: Elementary>([xx, xy]: [S; 2], g: Vector<S>) -> Vector<S> {
    Vector::new(xx * g.x + xy * g.y, xy * g.x - xx * g.y)
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "nematic_stress",
    formula: "f_v = −ζ Q ∂A/∂r_v",
    meaning: "Elongated cells pull (or push) along their long axis, as stress fibres do.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "ζ",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(NematicStress)]),
};
