//! Large strains of odd viscoelastic liquids: the Gordon–Schowalter derivative in steady simple shear.

use crate::EvenOdd;

/// An odd liquid of one relaxation whose stress is convected, the Johnson–Segalman model of the paper (SI, "Chiral active viscoelasticity"):
///
/// ```text
/// D_t σ + Ωσ − σΩ − a (Eσ + σE) = κ ∇v − Rσ,     Ω_ij = (∂_i v_j − ∂_j v_i)/2,  E_ij = (∂_i v_j + ∂_j v_i)/2
/// ```
///
/// a = 1 is upper-convected, 0 corotational, −1 lower-convected; the paper's printed a has the other sign. Elasticity κ and relaxation R act on
/// the two shears as `[[even, odd], [−odd, even]]`; the isotropic part of the stress relaxes by a rate of its own and has no source where areas stay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JohnsonSegalman {
    /// Shear modulus and odd shear modulus, `μ` and `Kᵒ`.
    pub elasticity: EvenOdd,
    /// Rates of relaxation of the two shears, even and odd.
    pub relaxation: EvenOdd,
    /// That of the isotropic part of the stress.
    pub bulk_relaxation: f64,
    /// The slip parameter a.
    pub slip: f64,
}

/// The stress in steady shear `v_x = γ̇ y`, without the stress at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyShear {
    /// `(σ_xy + σ_yx)/2`
    pub shear: f64,
    /// `(σ_xx − σ_yy)/2`, half the first normal stress difference.
    pub normal: f64,
    /// `(σ_xx + σ_yy)/2`
    pub isotropic: f64,
}

impl JohnsonSegalman {
    /// The stress in steady simple shear at a rate `γ̇`:
    ///
    /// ```text
    /// s₂ [ r + (γ̇ − rᵒ)²/r − a² γ̇²/r_b ] = μ γ̇ − (γ̇ − rᵒ) Kᵒ γ̇/r,     s₁ = [(γ̇ − rᵒ) s₂ + Kᵒ γ̇]/r,     p = a γ̇ s₂/r_b
    /// ```
    ///
    /// Viscosity and normal stress of an odd liquid depend on the sense of the shear; reversing it together with `Kᵒ` and `rᵒ` is a mirror image.
    ///
    /// ```
    /// use voronudge_theory::JohnsonSegalman;
    /// // The upper-convected Maxwell model: a constant viscosity G/r, and N₁ = 2 G γ̇²/r².
    /// let liquid = JohnsonSegalman { elasticity: [2.0, 0.0], relaxation: [0.5, 0.0], bulk_relaxation: 0.5, slip: 1.0 };
    /// let found = liquid.steady_shear(3.0);
    /// assert!((found.shear - 12.0).abs() < 1e-12 && (2.0 * found.normal - 144.0).abs() < 1e-10);
    /// ```
    pub fn steady_shear(&self, rate: f64) -> SteadyShear {
        let ([mu, odd], [r, r_odd]) = (self.elasticity, self.relaxation);
        let turning = rate - r_odd;
        let resistance = r + turning * turning / r - (self.slip * rate).powi(2) / self.bulk_relaxation;
        let shear = (mu - turning * odd / r) * rate / resistance;
        SteadyShear {
            shear,
            normal: (turning * shear + odd * rate) / r,
            isotropic: self.slip * rate * shear / self.bulk_relaxation,
        }
    }

    /// Viscosities `η, ηᵒ` of slow shear: `κ` over `R`.
    ///
    /// ```
    /// # use voronudge_theory::JohnsonSegalman;
    /// let liquid = JohnsonSegalman { elasticity: [2.0, 1.0], relaxation: [0.5, 0.2], bulk_relaxation: 0.5, slip: 0.3 };
    /// let (slow, [eta, odd]) = (liquid.steady_shear(1e-7), liquid.viscosity());
    /// assert!((slow.shear / 1e-7 - eta).abs() < 1e-5 && (slow.normal / 1e-7 - odd).abs() < 1e-5);
    /// ```
    pub fn viscosity(&self) -> EvenOdd {
        let ([mu, odd], [r, r_odd]) = (self.elasticity, self.relaxation);
        let square = r * r + r_odd * r_odd;
        [(mu * r + odd * r_odd) / square, (odd * r - mu * r_odd) / square]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;

    const LIQUID: JohnsonSegalman =
        JohnsonSegalman { elasticity: [1.0, -0.6], relaxation: [0.8, 0.3], bulk_relaxation: 1.1, slip: 0.4 };

    /// The tensors of the definition, followed in time until nothing changes.
    fn followed(liquid: &JohnsonSegalman, rate: f64) -> Matrix2<f64> {
        let gradient = Matrix2::new(0.0, 0.0, rate, 0.0); // ∂_i v_j
        let (omega, strain) =
            ((gradient - gradient.transpose()) * 0.5, (gradient + gradient.transpose()) * 0.5);
        let on_shears = |[even, odd]: EvenOdd, x: &Matrix2<f64>| {
            let [first, second] = [0.5 * (x[(0, 0)] - x[(1, 1)]), 0.5 * (x[(0, 1)] + x[(1, 0)])];
            let (first, second) = (even * first + odd * second, even * second - odd * first);
            Matrix2::new(first, second, second, -first)
        };
        let mut sigma = Matrix2::zeros();
        let step = 0.01;
        for _ in 0..20_000 {
            let part = Matrix2::identity() * (0.5 * sigma.trace());
            let slope = sigma * omega - omega * sigma
                + (strain * sigma + sigma * strain) * liquid.slip
                + on_shears(liquid.elasticity, &strain) * 2.0
                - on_shears(liquid.relaxation, &sigma)
                - part * liquid.bulk_relaxation;
            sigma += slope * step;
        }
        sigma
    }

    #[test]
    fn steady_shear_is_where_the_tensors_come_to() {
        for rate in [-1.2, -0.1, 0.3, 0.9] {
            let (found, sigma) = (LIQUID.steady_shear(rate), followed(&LIQUID, rate));
            assert!((found.shear - sigma[(0, 1)]).abs() < 1e-9, "{rate} {found:?} {sigma}");
            assert!((found.normal - 0.5 * (sigma[(0, 0)] - sigma[(1, 1)])).abs() < 1e-9, "{rate}");
            assert!((found.isotropic - 0.5 * sigma.trace()).abs() < 1e-9, "{rate}");
        }
    }

    /// Corotational and even: the viscosity falls as 1/(1 + γ̇²/r²).
    #[test]
    fn a_corotational_liquid_thins() {
        let liquid = JohnsonSegalman { elasticity: [2.0, 0.0], relaxation: [0.5, 0.0], slip: 0.0, ..LIQUID };
        for rate in [0.1, 1.0, 4.0] {
            let expected = 4.0 * rate / (1.0 + 4.0 * rate * rate);
            assert!((liquid.steady_shear(rate).shear - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_mirror_reverses_the_shear_and_what_is_odd() {
        let [mu, odd] = LIQUID.elasticity;
        let [r, r_odd] = LIQUID.relaxation;
        let mirrored = JohnsonSegalman { elasticity: [mu, -odd], relaxation: [r, -r_odd], ..LIQUID };
        let (found, image) = (LIQUID.steady_shear(0.7), mirrored.steady_shear(-0.7));
        assert!((found.shear + image.shear).abs() < 1e-12 && (found.normal - image.normal).abs() < 1e-12);
        assert!((found.shear.abs() - LIQUID.steady_shear(-0.7).shear.abs()).abs() > 0.1);
    }
}
