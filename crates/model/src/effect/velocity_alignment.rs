//! Cells that crawl turn into the direction in which they are moved.

use super::{Effect, Kind, Unit};
use crate::Parity;

/// The catalogue's entry. It has no column: it says how the polarities, unknown states of the cells, go on.
pub(super) const EFFECT: Effect = Effect {
    id: "velocity_alignment",
    formula: "dp_i/dt = −D_r p_i + κ F_i + noise",
    meaning: "Cells that crawl turn into the direction in which the forces move them.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "κ",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, _| Err(super::polarity_alignment::NO_POLARITY),
};
