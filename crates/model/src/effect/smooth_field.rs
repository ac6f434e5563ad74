//! A smooth flow of any form: a description, not a mechanism.

use super::profile::Wave;
use super::quadratic_distortion::monomials;
use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Domain, Elementary, Vector, quarter_turn};

/// Direction of a plane wave's velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Polarisation {
    /// Along the wave vector: without curl.
    #[default]
    Along,
    /// Across it: without divergence.
    Across,
}

/// A plane wave of velocities about the origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WaveFlow {
    /// The wave.
    pub wave: Wave,
    /// Direction of the velocity.
    pub polarisation: Polarisation,
}

impl ForceTerm for WaveFlow {
    fn name(&self) -> &'static str {
        "wave_flow"
    }

    fn formula(&self) -> &'static str {
        "q̂ sin(q·x), ẑ × q̂ sin(q·x)"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for WaveFlow {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let unit = self.wave.wavevector.normalize();
        let direction = match self.polarisation {
            Polarisation::Along => unit,
            Polarisation::Across => quarter_turn(unit),
        };
        let amplitude = self.wave.at(cell.from_origin()) * coefficient;
        forces.on_cell(Vector::new(amplitude * direction.x, amplitude * direction.y));
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "smooth_field",
    formula: "v = Σ c q̂ sin(q·x) + c′ ẑ × q̂ sin(q·x), or polynomials to third order",
    meaning: "A smooth flow of unknown origin across the tissue.",
    kind: Kind::Description,
    parity: Parity::Oriented,
    coefficients: "16 in a box, 18 in an open field",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, domain| {
        let Domain::Periodic(cell_box) = domain else {
            return Ok(monomials(1..=3));
        };
        let waves = Wave::lowest(cell_box);
        Ok(waves
            .into_iter()
            .flat_map(|wave| {
                [Polarisation::Along, Polarisation::Across]
                    .map(|polarisation| Column::from(WaveFlow { wave, polarisation }))
            })
            .collect())
    },
};
