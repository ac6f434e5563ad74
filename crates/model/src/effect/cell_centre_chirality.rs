//! Chirality that acts on the centre of the cell.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{
    BlockMatrix, Flow, FlowResponse, JacobianBuilder, Linearisation, Parity, Rows, VelocityAssembly,
};
use voronudge_geometry::{Scalar, Vector, quarter_turn};

/// The velocity of all forces that descend an energy, turned by a quarter at the centre of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CellCentreChirality;

impl FlowResponse for CellCentreChirality {
    fn name(&self) -> &'static str {
        "cell_centre_chirality"
    }

    fn formula(&self) -> &'static str {
        "ẑ × (−∂E/∂r)"
    }

    fn parity(&self) -> Parity {
        Parity::Chiral
    }

    fn conserves_momentum(&self) -> bool {
        true
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        let mut passive = Vec::new();
        let model = flow.model.passive();
        VelocityAssembly::default().evaluate_terms(flow.tessellation, flow.positions, &model, &mut passive);
        flow.each(|cell, _| quarter_turn(passive[cell]) * coefficient)
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let flow = &at.flow;
        let (model, mut passive) = (flow.model.passive(), BlockMatrix::default());
        JacobianBuilder::default().build_terms(flow.tessellation, flow.positions, &model, &mut passive);
        let turn = [0.0, -coefficient, coefficient, 0.0];
        Box::new(move |cell, row| row.add_row(&turn, &passive, cell))
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "cell_centre_chirality",
    formula: "v = v₀ + c ẑ × (−∂E/∂r)",
    meaning: "The cell as a whole moves at an angle to the force on it, instead of its cortex turning.",
    kind: Kind::Mechanism,
    parity: Parity::Chiral,
    coefficients: "c",
    unit: Unit { length: 0, time: 0 },
    aliases: &[Alias {
        of: "alpha",
        told_apart_by: "stress at the boundary: forces on cortices make an odd stress, turned velocities do not",
    }],
    columns: |_, _| Ok(vec![Column::from(CellCentreChirality)]),
};
