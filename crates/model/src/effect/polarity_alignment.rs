//! Cells that crawl turn towards their neighbours.

use super::{Effect, Kind, Unit};
use crate::Parity;

/// The catalogue's entry. It has no column: it says how the polarities, unknown states of the cells, hold each other.
pub(super) const EFFECT: Effect = Effect {
    id: "polarity_alignment",
    formula: "dp_i/dt = −D_r p_i + (J/6) Σ_j (p_j − p_i) + noise",
    meaning: "Cells that crawl turn towards their neighbours: at a rate J a cell takes on the mean polarity around it.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "J",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |_, _| Err(NO_POLARITY),
};

/// Why it cannot be tested on velocities.
pub(super) const NO_POLARITY: &str =
    "it says how polarities go on: give tracks of three frames or more, without velocities or --difference";
