//! What a tissue resists a gradient of density with.

use crate::{Error, MeanField};

/// A medium in which everything depends on `x` only, with the density `ρ` and the velocities `v_x`, `v_y`:
///
/// ```text
/// ζ v_x = −(B + μ) ∂_x ρ/ρ₀  + (η_B + η) ∂_x² v_x + ηᵒ ∂_x² v_y
/// ζ v_y = −(A − Kᵒ) ∂_x ρ/ρ₀ + (η_A − ηᵒ) ∂_x² v_x + η ∂_x² v_y
/// ```
///
/// the main text's viscoelastic equation with `ρ − ρ₀ = −ρ₀ ∂_x u_x`, viscosities where the moduli stand. Displacements along the
/// channel `u_y` are taken as forgotten: in the steady state they would grow without bound, and turnover and exchanges of neighbours
/// let go of them. Units: ζ = 1 and a mean area per cell of one, so that moduli and viscosities/time are rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelMedium {
    /// `B + μ`
    pub longitudinal: f64,
    /// `A − Kᵒ`
    pub transverse: f64,
    /// `η_B + η`
    pub longitudinal_viscosity: f64,
    /// `η`
    pub shear_viscosity: f64,
    /// `ηᵒ`
    pub odd_shear_viscosity: f64,
    /// `η_A`
    pub odd_bulk_viscosity: f64,
}

impl ChannelMedium {
    /// An elastic medium without viscosity.
    ///
    /// # Errors
    /// [`Error::Channel`] if `B + μ` is not positive or `A − Kᵒ` is not finite.
    pub fn elastic(longitudinal: f64, transverse: f64) -> Result<Self, Error> {
        Self {
            longitudinal,
            transverse,
            longitudinal_viscosity: 0.0,
            shear_viscosity: 0.0,
            odd_shear_viscosity: 0.0,
            odd_bulk_viscosity: 0.0,
        }
        .checked()
    }

    /// The medium of the mean-field theory, elastic.
    ///
    /// # Errors
    /// [`Error::Channel`] if `B + μ` is not positive.
    ///
    /// ```
    /// use voronudge_theory::{ChannelMedium, MeanField, Parameters};
    /// let theory = MeanField::new(Parameters { chirality: 2.9, preferred_perimeter: 4.0, ..Parameters::default() })?;
    /// let medium = ChannelMedium::mean_field(&theory)?;
    /// let ratio = medium.transverse / medium.longitudinal;
    /// assert!((ratio - theory.transverse_flow().unwrap()).abs() < 1e-12);
    /// # Ok::<(), voronudge_theory::Error>(())
    /// ```
    pub fn mean_field(theory: &MeanField) -> Result<Self, Error> {
        let moduli = theory.moduli();
        Self::elastic(moduli.bulk + moduli.shear, moduli.odd_bulk - moduli.odd_shear)
    }

    /// The same, if it resists compression and viscosities dissipate.
    ///
    /// # Errors
    /// [`Error::Channel`] if `B + μ` is not positive, a number is not finite, or an even viscosity is negative.
    pub fn checked(self) -> Result<Self, Error> {
        let longitudinal = self.longitudinal;
        if !(longitudinal.is_finite() && longitudinal > 0.0) {
            return Err(Error::Channel { name: "modulus B + μ", value: longitudinal });
        }
        let finite = [
            ("modulus A − Kᵒ", self.transverse),
            ("odd shear viscosity", self.odd_shear_viscosity),
            ("odd bulk viscosity", self.odd_bulk_viscosity),
        ];
        if let Some((name, value)) = finite.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::Channel { name, value });
        }
        let even = [
            ("longitudinal viscosity", self.longitudinal_viscosity),
            ("shear viscosity", self.shear_viscosity),
        ];
        match even.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            Some((name, value)) => Err(Error::Channel { name, value }),
            None => Ok(self),
        }
    }
}
