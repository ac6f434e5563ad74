//! Adhesion that changes across the tissue.

use super::{Alias, Column, Effect, Kind, Profile, Unit};
use crate::{Adhesion, ForceTerm, ModulatedTerm, Parity, Site, Term};
use voronudge_geometry::Elementary;

/// Adhesion proportional to a profile over position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AdhesionGradient {
    /// Its dependence on position.
    pub profile: Profile,
}

impl ForceTerm for AdhesionGradient {
    fn name(&self) -> &'static str {
        "p0_gradient"
    }

    fn formula(&self) -> &'static str {
        "x_k ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }
}

impl ModulatedTerm for AdhesionGradient {
    fn term(&self) -> Term {
        Adhesion.into()
    }

    fn weight<S: Elementary>(&self, site: &Site<'_, S>) -> S {
        self.profile.at(site.from_origin())
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "p0_gradient",
    formula: "f_v = Σ c_k x_k ∂P/∂r_v",
    meaning: "Adhesion, and with it the preferred perimeter, changes from one side of the tissue to the other.",
    kind: Kind::Mechanism,
    parity: Parity::Oriented,
    coefficients: "one for each profile: 2 in an open field, 4 in a box",
    unit: Unit { length: 0, time: -1 },
    aliases: &[Alias {
        of: "kp_gradient",
        told_apart_by: "cells of very different perimeter, or the response to a drug against contraction",
    }],
    columns: |_, domain| {
        Ok(Profile::ramps(domain).map(|profile| Column::from(AdhesionGradient { profile })).collect())
    },
};
