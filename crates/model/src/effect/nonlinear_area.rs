//! Resistance to changes of area that stiffens.

use super::{Column, Effect, Kind, Unit};
use crate::{ForceTerm, Parity, ShapeTerm, VertexForces};
use voronudge_geometry::{Arithmetic, Scalar, Shape};

/// The energy `⅓ (A − Ā)³`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonlinearArea {
    /// Mean area `Ā`.
    pub mean_area: f64,
}

impl Default for NonlinearArea {
    fn default() -> Self {
        Self { mean_area: 1.0 }
    }
}

impl ForceTerm for NonlinearArea {
    fn name(&self) -> &'static str {
        "nonlinear_area"
    }

    fn formula(&self) -> &'static str {
        "−(A − Ā)² ∂A/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
        let excess = shape.area - self.mean_area;
        Some(excess * excess * excess * (1.0 / 3.0))
    }
}

impl ShapeTerm for NonlinearArea {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        let excess = shape.area - self.mean_area;
        forces.along_area_gradient(-excess * excess * coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "nonlinear_area",
    formula: "f_v = −c (A − Ā)² ∂A/∂r_v",
    meaning: "Large cells resist a further change of area more than small ones.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: -4, time: -1 },
    aliases: &[],
    columns: |environment, _| {
        let mean_area = environment.cell_size().powi(2);
        Ok(vec![Column::from(NonlinearArea { mean_area })])
    },
};
