//! Uniform pure shear of an open tissue.

use super::{Column, Effect, Kind, Unit, open_only};
use crate::{Axis, CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

/// Uniform pure shear about the origin: `(x, −y)` along the axes, `(y, x)` along the diagonals.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shear {
    /// `X` for the shear along the axes, `Y` for that along the diagonals.
    pub axis: Axis,
}

impl ForceTerm for Shear {
    fn name(&self) -> &'static str {
        "shear"
    }

    fn formula(&self) -> &'static str {
        "(x, −y) or (y, x)"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for Shear {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let x = cell.from_origin();
        let flow = match self.axis {
            Axis::X => Vector::new(x.x, -x.y),
            Axis::Y => Vector::new(x.y, x.x),
        };
        forces.on_cell(flow * coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "shear",
    formula: "v = c₁ (x, −y) + c₂ (y, x)",
    meaning: "The tissue is stretched along one direction and narrows along the other.",
    kind: Kind::Mechanism,
    parity: Parity::Oriented,
    coefficients: "c₁, c₂",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, domain| {
        open_only(domain)?;
        Ok(Axis::BOTH.map(|axis| Column::from(Shear { axis })).to_vec())
    },
};
