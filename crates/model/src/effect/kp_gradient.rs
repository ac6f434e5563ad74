//! Contractility that changes across the tissue.

use super::{Alias, Column, Effect, Kind, Profile, Unit};
use crate::{Contractility, ForceTerm, ModulatedTerm, Parity, Site, Term};
use voronudge_geometry::Elementary;

/// Contractility proportional to a profile over position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContractilityGradient {
    /// Its dependence on position.
    pub profile: Profile,
}

impl ForceTerm for ContractilityGradient {
    fn name(&self) -> &'static str {
        "kp_gradient"
    }

    fn formula(&self) -> &'static str {
        "−x_k P ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }
}

impl ModulatedTerm for ContractilityGradient {
    fn term(&self) -> Term {
        Contractility.into()
    }

    fn weight<S: Elementary>(&self, site: &Site<'_, S>) -> S {
        self.profile.at(site.from_origin())
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "kp_gradient",
    formula: "f_v = −Σ c_k x_k P ∂P/∂r_v",
    meaning: "The cortex contracts more strongly on one side of the tissue than on the other.",
    kind: Kind::Mechanism,
    parity: Parity::Oriented,
    coefficients: "one for each profile: 2 in an open field, 4 in a box",
    unit: Unit { length: -1, time: -1 },
    aliases: &[Alias {
        of: "p0_gradient",
        told_apart_by: "cells of very different perimeter, or the response to a drug against contraction",
    }],
    columns: |_, domain| {
        Ok(Profile::ramps(domain).map(|profile| Column::from(ContractilityGradient { profile })).collect())
    },
};
