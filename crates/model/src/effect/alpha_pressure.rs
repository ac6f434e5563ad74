//! A torque of the pressure.

use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// The pressure `A − ℓ_0²` turned by a quarter. A constant part of the pressure is a gauge: the areas that meet at a vertex add up
/// to the same, so it changes no velocity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AlphaPressure;

impl ForceTerm for AlphaPressure {
    fn name(&self) -> &'static str {
        "alpha_pressure"
    }

    fn formula(&self) -> &'static str {
        "(A − ℓ_0²) ẑ × ∂A/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl RingTerm for AlphaPressure {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let polygon = cell.polygon;
        let excess = polygon.shape().area - cell.environment.cell_size().powi(2);
        let pressure = coefficient * excess;
        forces.on_vertices(polygon, |m| quarter_turn(polygon.area_gradient(m)) * pressure);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "alpha_pressure",
    formula: "f_v = c (A − ℓ_0²) ẑ × ∂A/∂r_v",
    meaning: "A cell that is too large or too small turns its surroundings.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: -2, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(AlphaPressure)]),
};
