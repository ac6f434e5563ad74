use super::{ForceTerm, Parity, ShapeTerm};
use crate::VertexForces;
use voronudge_geometry::{Arithmetic, Shape};

/// Cortical chirality, coefficient `K_P α`: the contraction turned by a quarter, `ẑ × ∂E_C/∂r_v = P ẑ × ∂P/∂r_v`.
///
/// The turn acts on the force at the vertex. No energy has this force as its gradient.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CorticalChirality;

impl ForceTerm for CorticalChirality {
    fn name(&self) -> &'static str {
        "cortical_chirality"
    }

    fn formula(&self) -> &'static str {
        "P ẑ × ∂P/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }
}

impl ShapeTerm for CorticalChirality {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        forces.along_turned_perimeter_gradient(shape.perimeter * coefficient);
    }
}
