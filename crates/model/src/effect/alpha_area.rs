//! Chirality that depends on the size of the cell.

use super::{Column, Effect, Kind, Unit};
use crate::{ForceTerm, Parity, ShapeTerm, VertexForces};
use voronudge_geometry::{Arithmetic, Shape};

/// Cortical chirality of a strength that grows with the area of the cell beyond the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlphaArea {
    /// Mean area `Ā`.
    pub mean_area: f64,
}

impl Default for AlphaArea {
    fn default() -> Self {
        Self { mean_area: 1.0 }
    }
}

impl ForceTerm for AlphaArea {
    fn name(&self) -> &'static str {
        "alpha_area"
    }

    fn formula(&self) -> &'static str {
        "(A − Ā) P ẑ × ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl ShapeTerm for AlphaArea {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        let excess = shape.area - self.mean_area;
        forces.along_turned_perimeter_gradient(excess * shape.perimeter * coefficient);
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "alpha_area",
    formula: "f_v = c (A − Ā) P ẑ × ∂P/∂r_v",
    meaning: "Large cells are more chiral than small ones (c > 0) or less.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: -2, time: -1 },
    aliases: &[],
    columns: |environment, _| {
        let mean_area = environment.cell_size().powi(2);
        Ok(vec![Column::from(AlphaArea { mean_area })])
    },
};
