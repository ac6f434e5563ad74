//! Tension of the free edge.

use super::{Alias, Column, Effect, Kind, Unit, open_only};
use crate::{CellElement, Environment, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Domain, Elementary, Vector};

/// A force on counted cells at the edge against their outward normal `n`, the sum of the unit vectors to neighbours beyond the
/// edge.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoundaryTension;

impl ForceTerm for BoundaryTension {
    fn name(&self) -> &'static str {
        "boundary_tension"
    }

    fn formula(&self) -> &'static str {
        "−n"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for BoundaryTension {
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        forces.on_cell(-outward(cell) * coefficient);
    }
}

/// Sum of the unit vectors to neighbours beyond the edge, for a cell that counts; zero otherwise.
pub(super) fn outward<S: Elementary>(cell: &CellElement<'_, S>) -> Vector<S> {
    let zero = S::constant(0.0);
    let mut normal = Vector::new(zero, zero);
    if cell.environment.is_beyond_edge(cell.cell) {
        return normal;
    }
    for ((direction, _), &j) in cell.directions().zip(cell.neighbours) {
        if cell.environment.is_beyond_edge(j as usize) {
            normal += direction;
        }
    }
    normal
}

/// The edge of an open field, or why there is none.
pub(super) fn needs_edge(environment: &Environment, domain: Domain) -> Result<(), &'static str> {
    open_only(domain)?;
    if environment.has_edge() { Ok(()) } else { Err("no edge of the tissue was given") }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "boundary_tension",
    formula: "v = −c n at the edge",
    meaning: "The free edge of the tissue pulls inwards (c > 0), or cells crawl out of it (c < 0).",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[Alias {
        of: "expansion",
        told_apart_by: "a larger piece of tissue: expansion grows towards the edge, the tension acts at the edge only",
    }],
    columns: |environment, domain| {
        needs_edge(environment, domain)?;
        Ok(vec![Column::from(BoundaryTension)])
    },
};
