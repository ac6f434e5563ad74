//! Chirality that scales with adhesion instead of contraction.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{ForceTerm, Parity, ShapeTerm, VertexForces};
use voronudge_geometry::{Arithmetic, Shape};

/// The adhesion turned by a quarter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AlphaAdhesion;

impl ForceTerm for AlphaAdhesion {
    fn name(&self) -> &'static str {
        "alpha_adhesion"
    }

    fn formula(&self) -> &'static str {
        "−ẑ × ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl ShapeTerm for AlphaAdhesion {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, _shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        forces.along_turned_perimeter_gradient(-coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "alpha_adhesion",
    formula: "f_v = −c ẑ × ∂P/∂r_v",
    meaning: "The part of the cortex that acts along the border has a fixed strength and does not grow with the perimeter.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 1, time: -1 },
    aliases: &[Alias {
        of: "alpha",
        told_apart_by: "cells of very different perimeter, such as after a change of density",
    }],
    columns: |_, _| Ok(vec![Column::from(AlphaAdhesion)]),
};
