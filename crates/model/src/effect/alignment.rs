//! Cells follow their neighbours.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

/// The mean earlier velocity of the neighbours for which it is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Alignment;

impl ForceTerm for Alignment {
    fn name(&self) -> &'static str {
        "alignment"
    }

    fn formula(&self) -> &'static str {
        "⟨v_j(earlier)⟩"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for Alignment {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let known = cell.neighbours.iter().filter_map(|&j| cell.environment.earlier(j as usize));
        let (sum, count) =
            known.fold((Vector::zeros(), 0), |(sum, count), v: Vector<f64>| (sum + v, count + 1));
        if count > 0 {
            let mean = sum / f64::from(count);
            forces.on_cell(Vector::new(coefficient * mean.x, coefficient * mean.y));
        }
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "alignment",
    formula: "v_i = c ⟨v_j(earlier)⟩",
    meaning: "A cell follows its neighbours: it aligns its motion with what they did before.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: 0 },
    aliases: &[Alias {
        of: "persistence",
        told_apart_by: "shorter intervals between frames, or mosaic tissues in which only some cells are polarised",
    }],
    columns: |environment, _| {
        if !environment.has_history() {
            return Err("no earlier velocities were given");
        }
        Ok(vec![Column::from(Alignment)])
    },
};
