//! What parameters imply by the mean-field theory of the honeycomb.

use schemars::JsonSchema;
use serde::Serialize;

use super::Parameter;

/// Moduli and phase diffusivities of the honeycomb at the fitted parameters.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the names of the file")]
pub struct ImpliedByMeanField {
    /// Bulk modulus B over γ.
    pub B: Parameter,
    /// Odd bulk modulus A over γ, which is zero in the theory.
    pub A: Parameter,
    /// Shear modulus μ over γ.
    pub mu: Parameter,
    /// Odd shear modulus Kᵒ over γ.
    pub K_o: Parameter,
    /// D_∥ = B/ζ.
    pub D_parallel: Parameter,
    /// D_⊥ = μ/ζ.
    pub D_perp: Parameter,
    /// D_∥^× = −A/ζ.
    pub D_parallel_cross: Parameter,
    /// D_⊥^× = Kᵒ/ζ.
    pub D_perp_cross: Parameter,
}
