//! Cells differ: each has a parameter of its own.

use super::{Effect, Kind, Unit};
use crate::{CellParameter, Parity};

/// The catalogue's entries. They have no columns: what cells have of their own are random effects.
pub(super) const ADHESION: Effect = Effect {
    id: "p0_heterogeneity",
    formula: "P_0i = P_0 (1 + u_i), ⟨u²⟩ = s²",
    meaning: "Cells differ in their preferred perimeter: each has one of its own.",
    ..OF_CELLS
};
pub(super) const AREA: Effect = Effect {
    id: "a0_heterogeneity",
    formula: "A_0i = A_0 (1 + u_i), ⟨u²⟩ = s²",
    meaning: "Cells differ in their preferred area: some are large and some small by themselves.",
    ..OF_CELLS
};
pub(super) const CHIRALITY: Effect = Effect {
    id: "alpha_heterogeneity",
    formula: "α_i = α (1 + u_i), ⟨u²⟩ = s²",
    meaning: "Cells differ in their chirality: each has one of its own.",
    parity: Parity::Chiral,
    ..OF_CELLS
};

const OF_CELLS: Effect = Effect {
    id: "",
    formula: "",
    meaning: "",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "s",
    unit: Unit { length: 0, time: 0 },
    aliases: &[],
    columns: |_, _| Err(NO_COLUMN),
};

/// Why it is no term of a model of cells that are alike.
const NO_COLUMN: &str = "it is no term that all cells share: simulate --cell-parameter gives cells their own, infer --vary and discover look for them";

/// The parameter in which cells differ, if that is what an effect says.
pub(super) fn parameter(effect: &Effect) -> Option<CellParameter> {
    let all = [
        (ADHESION, CellParameter::PreferredPerimeter),
        (AREA, CellParameter::PreferredArea),
        (CHIRALITY, CellParameter::Chirality),
    ];
    all.into_iter().find(|(own, _)| own.id == effect.id).map(|(_, parameter)| parameter)
}
