//! Chirality that changes across the tissue.

use super::{Column, Effect, Kind, Profile, Unit};
use crate::{CorticalChirality, ForceTerm, ModulatedTerm, Parity, Site, Term};
use voronudge_geometry::Elementary;

/// Cortical chirality proportional to a profile over position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChiralityGradient {
    /// Its dependence on position.
    pub profile: Profile,
}

impl ForceTerm for ChiralityGradient {
    fn name(&self) -> &'static str {
        "alpha_gradient"
    }

    fn formula(&self) -> &'static str {
        "x_k P ẑ × ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }
}

impl ModulatedTerm for ChiralityGradient {
    fn term(&self) -> Term {
        CorticalChirality.into()
    }

    fn weight<S: Elementary>(&self, site: &Site<'_, S>) -> S {
        self.profile.at(site.from_origin())
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "alpha_gradient",
    formula: "f_v = Σ c_k x_k P ẑ × ∂P/∂r_v",
    meaning: "Cells are more chiral on one side of the tissue than on the other.",
    kind: Kind::Mechanism,
    parity: Parity::Oriented,
    coefficients: "one for each profile: 2 in an open field, 4 in a box",
    unit: Unit { length: -1, time: -1 },
    aliases: &[],
    columns: |_, domain| {
        Ok(Profile::ramps(domain).map(|profile| Column::from(ChiralityGradient { profile })).collect())
    },
};
