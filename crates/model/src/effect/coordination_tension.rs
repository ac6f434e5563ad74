//! A tension that depends on the number of neighbours.

use super::{Column, Effect, Kind, Unit};
use crate::{Adhesion, ForceTerm, ModulatedTerm, Parity, Site, Term};
use voronudge_geometry::Elementary;

/// Adhesion in proportion to the number `z` of neighbours beyond six.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoordinationTension;

impl ForceTerm for CoordinationTension {
    fn name(&self) -> &'static str {
        "coordination_tension"
    }

    fn formula(&self) -> &'static str {
        "(z − 6) ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }
}

impl ModulatedTerm for CoordinationTension {
    fn term(&self) -> Term {
        Adhesion.into()
    }

    fn weight<S: Elementary>(&self, site: &Site<'_, S>) -> S {
        S::constant(site.neighbours as f64 - 6.0)
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "coordination_tension",
    formula: "f_v = c (z − 6) ∂P/∂r_v",
    meaning: "Cells with many neighbours have a longer preferred perimeter than cells with few.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Ok(vec![Column::from(CoordinationTension)]),
};
