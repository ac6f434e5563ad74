//! Cells keep on in the direction of before.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

/// The velocity of the cell in an earlier interval; zero where it is not known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Persistence;

impl ForceTerm for Persistence {
    fn name(&self) -> &'static str {
        "persistence"
    }

    fn formula(&self) -> &'static str {
        "v_i(earlier)"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for Persistence {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        if let Some(v) = cell.environment.earlier(cell.cell) {
            forces.on_cell(Vector::new(coefficient * v.x, coefficient * v.y));
        }
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "persistence",
    formula: "v_i = c v_i(earlier)",
    meaning: "A cell keeps moving as it did before: a polarity that persists.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: 0 },
    aliases: &[Alias {
        of: "time_lag",
        told_apart_by: "shorter intervals between frames: persistence then stays, a lag shrinks",
    }],
    columns: |environment, _| {
        if !environment.has_history() {
            return Err("no earlier velocities were given");
        }
        Ok(vec![Column::from(Persistence)])
    },
};
