//! All velocities are scaled.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{Flow, FlowResponse, Linearisation, Parity, Rows};
use voronudge_geometry::{Scalar, Vector};

/// The velocities times a factor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlowGain;

impl FlowResponse for FlowGain {
    fn name(&self) -> &'static str {
        "flow_gain"
    }

    fn formula(&self) -> &'static str {
        "v₀"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        true
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        flow.each(|_, v| v * coefficient)
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let Linearisation { flow, jacobian } = at;
        Box::new(move |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            row.add_scaled_row(coefficient, jacobian, cell);
        })
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "flow_gain",
    formula: "v = v₀ + s v₀",
    meaning: "The calibration of length, time or velocity is wrong: indistinguishable from faster forces of all kinds.",
    kind: Kind::Observation,
    parity: Parity::Achiral,
    coefficients: "s",
    unit: Unit { length: 0, time: 0 },
    aliases: &[Alias {
        of: "all parameters",
        told_apart_by: "none from velocities: calibrate lengths and times",
    }],
    columns: |_, _| Ok(vec![Column::from(FlowGain)]),
};
