//! Velocities belong to another moment than positions.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{Exactness, Flow, FlowResponse, Linearisation, Parity, Rows};
use voronudge_geometry::{Scalar, Vector};

/// The change of the velocities over a time, `J v₀`. Cells without a velocity are held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TimeLag;

impl FlowResponse for TimeLag {
    fn name(&self) -> &'static str {
        "time_lag"
    }

    fn formula(&self) -> &'static str {
        "J v₀"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        true
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        let rate = flow.along(&flow.held());
        flow.each(|cell, _| rate[cell] * coefficient)
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let Linearisation { flow, jacobian } = at;
        Box::new(move |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            for (j, block) in jacobian.row(cell) {
                row.add_row(&block.map(|entry| entry * coefficient), jacobian, j);
            }
        })
    }

    fn exactness(&self) -> Exactness {
        Exactness::FirstOrder
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "time_lag",
    formula: "v = v₀ + τ J v₀",
    meaning: "The velocities belong to a moment τ after the positions, as those over an interval do.",
    kind: Kind::Observation,
    parity: Parity::Achiral,
    coefficients: "τ",
    unit: Unit { length: 0, time: 1 },
    aliases: &[Alias { of: "persistence", told_apart_by: "shorter intervals between frames" }],
    columns: |_, _| Ok(vec![Column::from(TimeLag)]),
};
