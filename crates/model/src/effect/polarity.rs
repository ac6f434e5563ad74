//! Cells crawl: each has a velocity of its own that it forgets slowly.

use super::{Effect, Kind, Unit};
use crate::Parity;

/// The catalogue's entry. It has no column: the polarities are unknown states of the cells, and the fit of tracks finds them.
pub(super) const EFFECT: Effect = Effect {
    id: "polarity",
    formula: "v_i = F_i + p_i, dp_i/dt = −D_r p_i + noise",
    meaning: "Cells crawl: each has a polarity of its own that it keeps for a time 1/D_r.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "v₀ = √⟨p²⟩, D_r",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, _| Err(NO_TRACKS),
};

/// Why it cannot be tested on velocities.
const NO_TRACKS: &str =
    "it shows in how cells go on: give tracks of three frames or more, without velocities or --difference";
