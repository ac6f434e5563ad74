use super::{ForceTerm, Parity, ShapeTerm};
use crate::VertexForces;
use voronudge_geometry::{Arithmetic, Scalar, Shape};

/// Contractility of the cortex, coefficient `K_P`: `E_C = ½ P²`, so a vertex feels `−P ∂P/∂r_v`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contractility;

impl ForceTerm for Contractility {
    fn name(&self) -> &'static str {
        "contractility"
    }

    fn formula(&self) -> &'static str {
        "−P ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
        let perimeter = shape.perimeter;
        Some(perimeter * perimeter * 0.5)
    }
}

impl ShapeTerm for Contractility {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        forces.along_perimeter_gradient(-shape.perimeter * coefficient);
    }
}
