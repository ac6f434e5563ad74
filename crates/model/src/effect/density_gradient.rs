//! Motion up or down the density of cells.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector, dot};

/// The gradient of a smoothed density, `Σ_j (ℓ_ij/ℓ_0) w(d_ij) d̂_ij` over the neighbours of a cell,
/// with `ℓ_ij` the length of the common side and the compact kernel `w(d) = (1 − d²/R²)⁴` for `d < R = 2 ℓ_0`.
///
/// Each neighbour pulls along the line to it, the more the nearer it is and the longer the common side. In a uniform
/// surrounding the pulls cancel, because the sides of a polygon close. A side that shrinks to nothing takes its pull
/// with it, so the column is continuous at a T1 transition.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DensityGradient;

impl ForceTerm for DensityGradient {
    fn name(&self) -> &'static str {
        "density_gradient"
    }

    fn formula(&self) -> &'static str {
        "Σ (ℓ_ij/ℓ_0) w(d_ij) d̂_ij"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }
}

impl RingTerm for DensityGradient {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        for m in 0..cell.neighbours.len() {
            let pull = contact_pull(cell, m) * (coefficient * 0.5);
            forces.on_pair(m, -pull);
        }
    }
}

/// The pull of the neighbour across side `m`.
pub(super) fn contact_pull<S: Elementary>(cell: &CellElement<'_, S>, m: usize) -> Vector<S> {
    let unit = 1.0 / cell.environment.cell_size();
    let (length, _) = cell.side(m);
    let d = cell.polygon.ring()[m];
    let square = dot(d, d);
    let inside = -square * (0.25 * unit * unit) + 1.0;
    if inside.real() <= 0.0 {
        return Vector::new(S::constant(0.0), S::constant(0.0));
    }
    d * (square.root().inverse() * inside.power(4) * length * unit)
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "density_gradient",
    formula: "v = c Σ (ℓ_ij/ℓ_0) w(d_ij) d̂_ij",
    meaning: "Cells move towards where neighbours are dense (c > 0) or away from there: attraction, contact guidance, pressure.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[Alias {
        of: "short_range_repulsion",
        told_apart_by: "a range of densities: repulsion acts between close pairs only",
    }],
    columns: |_, _| Ok(vec![Column::from(DensityGradient)]),
};
