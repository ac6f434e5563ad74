//! Phase diffusion: how slow deformations of a pattern of cells relax.

use crate::Moduli;

/// Coefficients of the phase diffusion equation of a pattern of cells (area per time),
///
/// ```text
/// ∂_t u = D_∥ ∇(∇·u) + D_⊥ Δu + D_∥^× ε·∇(∇·u) + D_⊥^× ε·Δu,      ε_xy = −ε_yx = 1
/// ```
///
/// so that `ε·(a, b) = (b, −a)`, a clockwise quarter turn, `−ẑ×`. In components along a wave vector q and a quarter turn ahead of it,
/// `∂_t u = −D(q) u` with
///
/// ```text
/// D(q) = q² [ D_∥ + D_⊥          D_⊥^× ]
///           [ −D_∥^× − D_⊥^×     D_⊥   ]
/// ```
///
/// Comparison with `D(q) = q² [[B + μ, Kᵒ], [A − Kᵒ, μ]]/ζ` of [`Moduli`] gives the dictionary
///
/// ```text
/// D_∥ = B/ζ      D_⊥ = μ/ζ      D_⊥^× = Kᵒ/ζ      D_∥^× = −A/ζ
/// ```
///
/// With the other sign of ε it is D_⊥^× that changes sign, so no choice makes all four signs those of the paper, which prints
/// D_∥^× = A/ζ. Its own equation of elasticity has `(B − A ε)·∇(∇·u)`, which agrees with the minus sign. Derivation:
/// `docs/mean-field.md`, "Phase diffusion".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseDiffusivities {
    /// `D_∥`: compression.
    pub parallel: f64,
    /// `D_⊥`: any gradient.
    pub perpendicular: f64,
    /// `D_∥^×`: compression drives cells sideways.
    pub parallel_cross: f64,
    /// `D_⊥^×`: any gradient drives cells a quarter turn aside.
    pub perpendicular_cross: f64,
}

impl PhaseDiffusivities {
    /// The diffusivities of a medium with these moduli and the friction ζ per area, in the units of moduli over friction. With moduli of
    /// [`crate::MeanField::moduli`], which are rates times areas, the friction is 1.
    ///
    /// ```
    /// use voronudge_theory::{MeanField, Parameters, PhaseDiffusivities};
    /// let theory = MeanField::new(Parameters { chirality: 0.3, ..Parameters::default() })?;
    /// let diffusivities = PhaseDiffusivities::from_moduli(theory.moduli(), 1.0);
    /// assert!(diffusivities.perpendicular_cross < 0.0);
    /// assert_eq!(diffusivities.moduli(1.0), theory.moduli());
    /// # Ok::<(), voronudge_theory::Error>(())
    /// ```
    pub fn from_moduli(moduli: Moduli, friction: f64) -> Self {
        let Moduli { bulk, odd_bulk, shear, odd_shear } = moduli;
        Self {
            parallel: bulk / friction,
            perpendicular: shear / friction,
            parallel_cross: (0.0 - odd_bulk) / friction,
            perpendicular_cross: odd_shear / friction,
        }
    }

    /// The moduli of a medium with these diffusivities and the friction ζ per area.
    pub fn moduli(&self, friction: f64) -> Moduli {
        Moduli {
            bulk: self.parallel * friction,
            odd_bulk: 0.0 - self.parallel_cross * friction,
            shear: self.perpendicular * friction,
            odd_shear: self.perpendicular_cross * friction,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MeanField, Orientation, Parameters};

    /// −∂_t u of a wave, term by term of the equation, in Cartesian components.
    fn rate(d: &PhaseDiffusivities, q: [f64; 2], u: [f64; 2]) -> [f64; 2] {
        let clockwise = |[a, b]: [f64; 2]| [b, -a];
        let divergence = q[0] * u[0] + q[1] * u[1];
        let gradient = q.map(|q| q * divergence);
        let laplacian = u.map(|u| (q[0] * q[0] + q[1] * q[1]) * u);
        let (turned_gradient, turned_laplacian) = (clockwise(gradient), clockwise(laplacian));
        std::array::from_fn(|axis| {
            d.parallel * gradient[axis]
                + d.perpendicular * laplacian[axis]
                + d.parallel_cross * turned_gradient[axis]
                + d.perpendicular_cross * turned_laplacian[axis]
        })
    }

    /// The equation with the honeycomb's diffusivities is its dynamical matrix for long waves of any direction: the sign of ε is right.
    #[test]
    fn long_waves_of_the_honeycomb_diffuse() {
        let parameters = Parameters {
            area_elasticity: 0.2,
            preferred_perimeter: 3.2,
            chirality: 0.4,
            ..Parameters::default()
        };
        let theory = MeanField::new(parameters).unwrap();
        let diffusivities = PhaseDiffusivities::from_moduli(theory.moduli(), 1.0);
        for angle in [0.0, 0.4, 1.1, 2.5] {
            let q = [1e-3 * f64::cos(angle), 1e-3 * f64::sin(angle)];
            let matrix = theory.dynamical_matrix(q, Orientation::NeighbourAlongX).unwrap();
            for u in [[1.0, 0.0], [0.3, -0.8]] {
                let expected = rate(&diffusivities, q, u);
                for axis in 0..2 {
                    let found = matrix[axis][0] * u[0] + matrix[axis][1] * u[1];
                    // The next term is of order q² relative to this one.
                    assert!((found - expected[axis]).abs() < 1e-5 * 1e-6, "{found} {expected:?}");
                }
            }
        }
    }

    /// The matrix in the documentation is that of the terms, also with an odd bulk modulus, which the honeycomb lacks.
    #[test]
    fn the_matrix_and_the_dictionary() {
        let moduli = Moduli { bulk: 2.0, odd_bulk: 0.7, shear: 0.9, odd_shear: -0.4 };
        let d = PhaseDiffusivities::from_moduli(moduli, 2.0);
        assert_eq!(d.moduli(2.0), moduli);
        let (q, sine, cosine) = (1.3, 0.6, 0.8);
        let (along, ahead) = ([cosine, sine], [-sine, cosine]);
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let wave = along.map(|x| q * x);
        let (first, second) = (rate(&d, wave, along), rate(&d, wave, ahead));
        let found = [[dot(along, first), dot(along, second)], [dot(ahead, first), dot(ahead, second)]];
        let expected = [
            [moduli.bulk + moduli.shear, moduli.odd_shear],
            [moduli.odd_bulk - moduli.odd_shear, moduli.shear],
        ];
        for i in 0..2 {
            for j in 0..2 {
                assert!((found[i][j] - q * q * expected[i][j] / 2.0).abs() < 1e-12);
            }
        }
    }
}
