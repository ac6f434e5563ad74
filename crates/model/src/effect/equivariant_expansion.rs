//! Forces between neighbours of any dependence on distance: a description, not a mechanism.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, quarter_turn};

/// Direction of a pair force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PairDirection {
    /// Along the line between the centres.
    #[default]
    Radial,
    /// Across it.
    Turned,
}

/// A pair force that acts within a shell of distances, `s_k(d) = exp(−((d − μ_k)/0.3 ℓ_0)²)` with `μ_k = 0.6, 1, 1.4 ℓ_0`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RadialShell {
    /// Number of the shell: 0, 1 or 2.
    pub shell: u8,
    /// Direction of the force.
    pub direction: PairDirection,
}

impl ForceTerm for RadialShell {
    fn name(&self) -> &'static str {
        "radial_shell"
    }

    fn formula(&self) -> &'static str {
        "s_k(d) d̂, ẑ × s_k(d) d̂"
    }

    fn parity(&self) -> Parity {
        match self.direction {
            PairDirection::Radial => Parity::Achiral,
            PairDirection::Turned => Parity::Chiral,
        }
    }
}

impl RingTerm for RadialShell {
    fn reach(&self) -> Reach {
        Reach::Pair
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let unit = 1.0 / cell.environment.cell_size();
        for (m, (direction, distance)) in cell.directions().enumerate() {
            let deviation = (distance * unit - (0.6 + 0.4 * f64::from(self.shell))) * (1.0 / 0.3);
            let weight = (-deviation * deviation).exponential() * coefficient * 0.5;
            let along = match self.direction {
                PairDirection::Radial => direction,
                PairDirection::Turned => quarter_turn(direction),
            };
            forces.on_pair(m, -along * weight);
        }
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "equivariant_expansion",
    formula: "v = Σ_k Σ_j s_k(d_ij) (c_k d̂_ij + c′_k ẑ × d̂_ij)",
    meaning: "Some force between neighbours whose dependence on distance is not known.",
    kind: Kind::Description,
    parity: Parity::Mixed,
    coefficients: "six: three shells, along and across",
    unit: Unit { length: 1, time: -1 },
    aliases: &[Alias {
        of: "short_range_repulsion",
        told_apart_by: "none: it contains every force between neighbours that depends on their distance",
    }],
    columns: |_, _| {
        let shells = (0..3).flat_map(|shell| {
            [PairDirection::Radial, PairDirection::Turned]
                .map(|direction| Column::from(RadialShell { shell, direction }))
        });
        Ok(shells.collect())
    },
};
