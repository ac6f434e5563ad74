//! Labelled cells with other parameters.

use super::{Column, Effect, Kind, Unit};
use crate::{CellElement, ForceTerm, Parity, RingForces, RingTerm};
use voronudge_geometry::{Scalar, quarter_turn};

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

impl RingTerm for LabelParameter {
    fn act<S: Scalar>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        if cell.environment.label(cell.cell) != Some(self.label) {
            return;
        }
        let polygon = cell.polygon;
        let perimeter = polygon.shape().perimeter;
        forces.on_vertices(polygon, |m| {
            let gradient = polygon.perimeter_gradient(m);
            match self.parameter {
                LabelledParameter::Adhesion => gradient * (coefficient * cell.environment.cell_size()),
                LabelledParameter::Contractility => -gradient * (coefficient * perimeter),
                LabelledParameter::Chirality => quarter_turn(gradient) * (coefficient * perimeter),
            }
        });
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
