//! Repulsion between close neighbours.

use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::Elementary;

/// A push from each neighbour along the line between the centres, with
/// `w(d) = (1 − d²/R²)⁴` for `d < R = 1.6 ℓ_0`: half of it is gone at 0.64 ℓ_0, and it vanishes where neighbours come and go.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShortRangeRepulsion;

impl ForceTerm for ShortRangeRepulsion {
    fn name(&self) -> &'static str {
        "short_range_repulsion"
    }

    fn formula(&self) -> &'static str {
        "−w(d) d̂"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }
}

impl RingTerm for ShortRangeRepulsion {
    fn reach(&self) -> Reach {
        Reach::Pair
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        for (m, (direction, distance)) in cell.directions().enumerate() {
            let push = range_weight(distance, cell.environment.cell_size()) * coefficient * 0.5;
            forces.on_pair(m, direction * push);
        }
    }
}

/// The weight `w(d)` of a pair at a distance, for cells of size `ℓ_0`.
pub(super) fn range_weight<S: Elementary>(distance: S, cell_size: f64) -> S {
    let ratio = distance * (1.0 / (1.6 * cell_size));
    let inside = -ratio * ratio + 1.0;
    if inside.real() > 0.0 { inside.power(4) } else { S::constant(0.0) }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "short_range_repulsion",
    formula: "v = −c Σ w(d_ij) d̂_ij",
    meaning: "Neighbouring cells push each other apart when their nuclei come too close.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(ShortRangeRepulsion)]),
};
