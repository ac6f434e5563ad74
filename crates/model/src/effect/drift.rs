//! A constant velocity of the whole tissue.

use super::{Column, Effect, Kind, Unit};
use crate::{Axis, CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

/// A constant velocity along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drift {
    /// Direction.
    pub axis: Axis,
}

impl ForceTerm for Drift {
    fn name(&self) -> &'static str {
        "drift"
    }

    fn formula(&self) -> &'static str {
        "ê"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for Drift {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, _cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let mut velocity = Vector::new(S::constant(0.0), S::constant(0.0));
        velocity[self.axis.index()] = coefficient;
        forces.on_cell(velocity);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "drift",
    formula: "v = (c₁, c₂)",
    meaning: "The whole sheet moves, or the microscope stage does.",
    kind: Kind::Observation,
    parity: Parity::Oriented,
    coefficients: "c₁, c₂",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(Axis::BOTH.map(|axis| Column::from(Drift { axis })).to_vec()),
};
