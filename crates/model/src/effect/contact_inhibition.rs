//! Cells that crawl turn away from their contacts.

use super::{Column, DensityGradient, Effect, Kind, Unit};
use crate::Parity;

/// What turns polarities away from contacts, `n_i = −Σ_j (ℓ_ij/ℓ_0) w(d_ij) d̂_ij`: a column with its coefficient. It is that of
/// [`DensityGradient`], the other way.
///
/// The sides of a polygon close, so that weights by the length of contacts alone would always cancel: a cell is pushed by those that are near.
/// Evenly surrounded cells have none.
pub fn away_from_contacts() -> (Column, f64) {
    (Column::from(DensityGradient), -1.0)
}

/// The catalogue's entry. It has no column: it says how the polarities, unknown states of the cells, go on.
pub(super) const EFFECT: Effect = Effect {
    id: "contact_inhibition",
    formula: "dp_i/dt = −D_r p_i − b Σ_j (ℓ_ij/ℓ_0) w(d_ij) d̂_ij + noise",
    meaning: "Cells that crawl turn away from their contacts, towards where there is room.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "b",
    unit: Unit { length: 1, time: -2 },
    aliases: &[],
    columns: |_, _| Err(super::polarity_alignment::NO_POLARITY),
};
