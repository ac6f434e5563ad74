use super::{ForceTerm, Parity, ShapeTerm};
use crate::VertexForces;
use voronudge_geometry::{Arithmetic, Scalar, Shape};

/// Adhesion, coefficient `K_P P_0`: `E_B = −P`, so a vertex feels `+∂P/∂r_v`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Adhesion;

impl ForceTerm for Adhesion {
    fn name(&self) -> &'static str {
        "adhesion"
    }

    fn formula(&self) -> &'static str {
        "∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
        Some(-shape.perimeter)
    }
}

impl ShapeTerm for Adhesion {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, _shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        forces.along_perimeter_gradient(coefficient);
    }
}
