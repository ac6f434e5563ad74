use super::{ForceTerm, Parity, ShapeTerm};
use crate::VertexForces;
use voronudge_geometry::{Arithmetic, Scalar, Shape};

/// Area elasticity, coefficient `K_A`: `E_A = ½ (A − A_0)²`, so a vertex feels `−(A − A_0) ∂A/∂r_v`.
///
/// `A_0` is a gauge: the areas that meet at a vertex always add up to the same, so it changes no velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaElasticity {
    /// Preferred area `A_0`.
    pub preferred_area: f64,
}

impl Default for AreaElasticity {
    fn default() -> Self {
        Self { preferred_area: 1.0 }
    }
}

impl ForceTerm for AreaElasticity {
    fn name(&self) -> &'static str {
        "area_elasticity"
    }

    fn formula(&self) -> &'static str {
        "−(A − A_0) ∂A/∂r_v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
        let excess = shape.area - self.preferred_area;
        Some(excess * excess * 0.5)
    }
}

impl ShapeTerm for AreaElasticity {
    #[inline(always)]
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
        forces.along_area_gradient((-shape.area + self.preferred_area) * coefficient);
    }
}
