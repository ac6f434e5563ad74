//! Labelled cells with other parameters.

use super::{Column, Effect, Kind, Unit};
use crate::{Adhesion, Contractility, CorticalChirality, ForceTerm, ModulatedTerm, Parity, Site, Term};
use voronudge_geometry::Elementary;

/// The parameter that differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LabelledParameter {
    /// Adhesion, in units of `ℓ_0`.
    #[default]
    Adhesion,
    /// Contractility.
    Contractility,
    /// Cortical chirality.
    Chirality,
}

impl LabelledParameter {
    const ALL: [Self; 3] = [Self::Adhesion, Self::Contractility, Self::Chirality];
}

/// One of the forces of the base model on cells of one label only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LabelParameter {
    /// Label of the cells.
    pub label: i64,
    /// What is different about them.
    pub parameter: LabelledParameter,
}

impl ForceTerm for LabelParameter {
    fn name(&self) -> &'static str {
        "label_parameter"
    }

    fn formula(&self) -> &'static str {
        "X on cells of one label"
    }

    fn parity(&self) -> Parity {
        match self.parameter {
            LabelledParameter::Chirality => Parity::Chiral,
            _ => Parity::Achiral,
        }
    }
}

impl ModulatedTerm for LabelParameter {
    fn term(&self) -> Term {
        match self.parameter {
            LabelledParameter::Adhesion => Adhesion.into(),
            LabelledParameter::Contractility => Contractility.into(),
            LabelledParameter::Chirality => CorticalChirality.into(),
        }
    }

    fn weight<S: Elementary>(&self, site: &Site<'_, S>) -> S {
        S::constant(match (site.environment.label(site.cell) == Some(self.label), self.parameter) {
            (false, _) => 0.0,
            (true, LabelledParameter::Adhesion) => site.environment.cell_size(),
            (true, _) => 1.0,
        })
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "label_parameter",
    formula: "f_v = c₁ ℓ_0 ∂P − c₂ P ∂P + c₃ P ẑ × ∂P on labelled cells",
    meaning: "Cells of one type adhere, contract or turn differently from the others.",
    kind: Kind::Mechanism,
    parity: Parity::Mixed,
    coefficients: "three for each label but the most frequent",
    unit: Unit { length: 0, time: -1 },
    aliases: &[],
    columns: |environment, _| {
        let labels = environment.other_labels();
        if environment.labels().is_empty() {
            return Err("no labels were given");
        }
        if labels.is_empty() {
            return Err("all labels are the same");
        }
        let columns = labels.into_iter().flat_map(|label| {
            LabelledParameter::ALL.map(|parameter| Column::from(LabelParameter { label, parameter }))
        });
        Ok(columns.collect())
    },
};
