//! A field from outside: a map of some other measurement.

use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::Elementary;

/// The vector of a supplied map at the position of the cell, zero outside of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExternalField {
    /// Index of the map.
    pub map: usize,
}

impl ForceTerm for ExternalField {
    fn name(&self) -> &'static str {
        "external_field"
    }

    fn formula(&self) -> &'static str {
        "E(x)"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for ExternalField {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        if let Some(map) = cell.environment.maps().get(self.map) {
            forces.on_cell(map.at(cell.position, cell.domain) * coefficient);
        }
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "external_field",
    formula: "v = c E(x)",
    meaning: "Cells follow a field that was measured or imposed: an electric field, a chemical gradient, a flow of the medium.",
    kind: Kind::Mechanism,
    parity: Parity::Oriented,
    coefficients: "one for each map",
    unit: Unit { length: 0, time: 0 },
    aliases: &[],
    columns: |environment, _| {
        if environment.maps().is_empty() {
            return Err("no external field was given");
        }
        Ok((0..environment.maps().len()).map(|map| Column::from(ExternalField { map })).collect())
    },
};
