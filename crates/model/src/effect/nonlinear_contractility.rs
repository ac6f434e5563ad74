//! Contraction that stiffens with the perimeter.

use super::{Column, Effect, Kind, Unit};
use crate::{ForceTerm, Parity, ShapeTerm, VertexForces};
use voronudge_geometry::{Arithmetic, Scalar, Shape};

/// The energy `⅓ (P − P̄)³`. `P̄` is the perimeter of a regular hexagon; another choice only shifts adhesion and contractility.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonlinearContractility {
    /// `P̄`
    pub mean_perimeter: f64,
}

impl Default for NonlinearContractility {
    fn default() -> Self {
        Self { mean_perimeter: hexagon_perimeter(1.0) }
    }
}

impl ForceTerm for NonlinearContractility {
    fn name(&self) -> &'static str {
        "nonlinear_contractility"
    }

    fn formula(&self) -> &'static str {
        "−(P − P̄)² ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
        let excess = shape.perimeter - self.mean_perimeter;
        Some(excess * excess * excess * (1.0 / 3.0))
    }
}

impl ShapeTerm for NonlinearContractility {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        let excess = shape.perimeter - self.mean_perimeter;
        forces.along_perimeter_gradient(-excess * excess * coefficient);
    }
}

/// Perimeter `6d` of a regular hexagon of area `ℓ_0² = (3√3/2) d²`.
fn hexagon_perimeter(cell_size: f64) -> f64 {
    6.0 * cell_size * (2.0 / (3.0 * 3f64.sqrt())).sqrt()
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "nonlinear_contractility",
    formula: "f_v = −c (P − P̄)² ∂P/∂r_v",
    meaning: "The cortex stiffens, or softens, when it is stretched.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: -1, time: -1 },
    aliases: &[],
    columns: |environment, _| {
        let mean_perimeter = hexagon_perimeter(environment.cell_size());
        Ok(vec![Column::from(NonlinearContractility { mean_perimeter })])
    },
};
