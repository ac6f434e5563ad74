//! Cells are moved at random, without a memory.

use super::{Effect, Kind, Unit};
use crate::Parity;

/// The catalogue's entry. It has no column: it is what the dynamics scatter by, which the fit of tracks finds.
pub(super) const EFFECT: Effect = Effect {
    id: "random_motion",
    formula: "dr_i = v_i dt + √(2D) dW_i",
    meaning: "Cells are moved at random, anew at every moment: what they do is forgotten at once.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "D",
    unit: Unit { length: 2, time: -1 },
    aliases: &[],
    columns: |_, _| Err(NO_TRACKS),
};

/// Why it cannot be tested on velocities.
const NO_TRACKS: &str = "of velocities it cannot be told from errors of these: give tracks of three frames or more, without velocities or \
     --difference";
