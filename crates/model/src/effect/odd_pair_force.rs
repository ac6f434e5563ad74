//! Transverse forces between close neighbours.

use super::short_range_repulsion::range_weight;
use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// As [`ShortRangeRepulsion`](super::ShortRangeRepulsion), across the line between the centres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OddPairForce;

impl ForceTerm for OddPairForce {
    fn name(&self) -> &'static str {
        "odd_pair_force"
    }

    fn formula(&self) -> &'static str {
        "ẑ × w(d) d̂"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl RingTerm for OddPairForce {
    fn reach(&self) -> Reach {
        Reach::Pair
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        for (m, (direction, distance)) in cell.directions().enumerate() {
            let push = range_weight(distance, cell.environment.cell_size()) * coefficient * 0.5;
            forces.on_pair(m, -quarter_turn(direction) * push);
        }
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "odd_pair_force",
    formula: "v = c ẑ × Σ w(d_ij) d̂_ij",
    meaning: "Close neighbours circle around each other, like spinning rotors.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(OddPairForce)]),
};
