//! Motion along the lines of equal density.

use super::density_gradient::contact_pull;
use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// The gradient of the smoothed density of [`DensityGradient`](super::DensityGradient), turned by a quarter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OddDiffusion;

impl ForceTerm for OddDiffusion {
    fn name(&self) -> &'static str {
        "odd_diffusion"
    }

    fn formula(&self) -> &'static str {
        "ẑ × Σ (ℓ_ij/ℓ_0) w(d_ij) d̂_ij"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl RingTerm for OddDiffusion {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        for m in 0..cell.neighbours.len() {
            let pull = contact_pull(cell, m) * (coefficient * 0.5);
            forces.on_pair(m, -quarter_turn(pull));
        }
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "odd_diffusion",
    formula: "v = c ẑ × Σ (ℓ_ij/ℓ_0) w(d_ij) d̂_ij",
    meaning: "Cells move along the edge of dense regions, always with the dense side on the same hand.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(OddDiffusion)]),
};
