//! Stress at 45° to the long axis of a cell.

use super::nematic_stress::contract;
use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::Elementary;

/// As [`NematicStress`](super::NematicStress) with the axis of the stress turned by 45° from the long axis of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OddNematicStress;

impl ForceTerm for OddNematicStress {
    fn name(&self) -> &'static str {
        "odd_nematic_stress"
    }

    fn formula(&self) -> &'static str {
        "−R(45°)Q ∂A/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl RingTerm for OddNematicStress {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let polygon = cell.polygon;
        let [xx, xy] = polygon.shape_tensor();
        let stress = [-xy * coefficient, xx * coefficient];
        forces.on_vertices(polygon, |m| -contract(stress, polygon.area_gradient(m)));
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "odd_nematic_stress",
    formula: "f_v = −ζ R(45°)Q ∂A/∂r_v",
    meaning: "Elongated cells pull at 45° to their long axis: a chiral stress that shapes set off.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "ζ",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(OddNematicStress)]),
};
