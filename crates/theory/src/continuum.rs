//! Long waves: elastic moduli, prestress, and the flow along a gradient of density.

use crate::{MeanField, Parameters, hexagon_perimeter, hexagon_side};

/// Elastic moduli of an isotropic plane medium (rate × area), with the stress about the prestress
///
/// ```text
/// (σ_xx + σ_yy)/2 = B ∇·u                  (σ_yx − σ_xy)/2 = A ∇·u
/// (σ_xx − σ_yy)/2 = μ e_1 + Kᵒ e_2         e_1 = ∂_x u_x − ∂_y u_y
/// (σ_xy + σ_yx)/2 = μ e_2 − Kᵒ e_1         e_2 = ∂_x u_y + ∂_y u_x
/// ```
///
/// so that `D(q) = q² [[B + μ, Kᵒ], [A − Kᵒ, μ]]` per unit area, for components along q and a quarter turn ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// Bulk modulus `B`.
    pub bulk: f64,
    /// Odd bulk modulus `A`.
    pub odd_bulk: f64,
    /// Shear modulus `μ`.
    pub shear: f64,
    /// Odd shear modulus `Kᵒ`.
    pub odd_shear: f64,
}

impl MeanField {
    /// The moduli of the honeycomb, with unit area Ā = 1:
    ///
    /// ```text
    /// B = 3 K_P P_0 d/2 + K_A      A = 0      μ = (9/4) K_P d (P_MF − P_0)      Kᵒ = −(9/2) K_P α d²  =  −√3 K_P α
    /// ```
    ///
    /// Derivation: `docs/mean-field.md`, "Long waves". The paper's Kᵒ has the opposite sign.
    pub fn moduli(&self) -> Moduli {
        let Parameters {
            area_elasticity: k_a,
            perimeter_elasticity: k_p,
            preferred_perimeter: p_0,
            chirality: alpha,
        } = self.parameters();
        let d = hexagon_side();
        Moduli {
            bulk: 1.5 * k_p * p_0 * d + k_a,
            odd_bulk: 0.0,
            shear: 2.25 * k_p * d * (hexagon_perimeter() - p_0),
            odd_shear: -4.5 * k_p * alpha * d * d,
        }
    }

    /// The prestress `σ⁰ = (K_P P_MF²/2) [[s, α], [−α, s]]` (rate × area), row = component of the force.
    ///
    /// The area elasticity adds the pressure of the gauge `A_0`, `K_A (1 − A_0)` on the diagonal, which is left out.
    /// Derivation: `docs/mean-field.md`, "Prestress". The paper prints α with the opposite sign.
    pub fn prestress(&self) -> [[f64; 2]; 2] {
        let Parameters { perimeter_elasticity: k_p, chirality: alpha, .. } = self.parameters();
        let scale = 0.5 * k_p * hexagon_perimeter().powi(2);
        let tension = scale * self.distance_to_limit();
        [[tension, scale * alpha], [-scale * alpha, tension]]
    }

    /// Ratio `v_y/v_x` of the velocities along and up a gradient of density in x, on neglect of viscosity:
    ///
    /// ```text
    /// v_y/v_x = (A − Kᵒ)/(B + μ) = +α/(3 − a P_0/ℓ_0),     a = 1/(6d) = 1/(2√(2√3)),     K_A = 0
    /// ```
    ///
    /// `None` if `B + μ` is not positive (`P_0 ≥ 18d` for K_A = 0), where the medium does not resist compression.
    /// Derivation: `docs/mean-field.md`, "Flow along a density gradient". The paper prints it with a minus sign.
    pub fn transverse_flow(&self) -> Option<f64> {
        let Moduli { bulk, odd_bulk, shear, odd_shear } = self.moduli();
        let longitudinal = bulk + shear;
        (longitudinal > 0.0).then(|| (odd_bulk - odd_shear) / longitudinal)
    }

    /// The chirality at which the ratio `v_y/v_x` of [`transverse_flow`](Self::transverse_flow) would be that; the chirality of the
    /// theory itself plays no part. `α = (v_y/v_x) (3 − a P_0/ℓ_0)` for K_A = 0.
    ///
    /// `None` if `B + μ` is not positive.
    ///
    /// ```
    /// use voronudge_theory::{MeanField, Parameters};
    /// let theory = MeanField::new(Parameters { preferred_perimeter: 4.0, chirality: 2.9, ..Parameters::default() })?;
    /// let ratio = theory.transverse_flow().unwrap();
    /// assert!((theory.chirality_of_flow(ratio).unwrap() - 2.9).abs() < 1e-12);
    /// # Ok::<(), voronudge_theory::Error>(())
    /// ```
    pub fn chirality_of_flow(&self, ratio: f64) -> Option<f64> {
        self.with_chirality(1.0).transverse_flow().map(|of_one| ratio / of_one)
    }
}
