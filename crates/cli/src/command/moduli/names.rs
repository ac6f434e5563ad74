//! Names and symbols of moduli and viscosities in reports.

/// Moduli in the order of [`Moduli::to_array`](voronudge_simulate::moduli::Moduli::to_array), by name and symbol.
pub(crate) const NAMES: [(&str, &str); 4] =
    [("bulk", "B"), ("odd_bulk", "A"), ("shear", "μ"), ("odd_shear", "Kᵒ")];

/// Viscosities, by name and symbol.
pub(crate) const VISCOSITY_NAMES: [(&str, &str); 2] =
    [("shear_viscosity", "η"), ("odd_shear_viscosity", "ηᵒ")];
