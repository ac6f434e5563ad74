//! Velocities are averaged over neighbours.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{Flow, FlowResponse, Linearisation, Parity, Rows};
use voronudge_geometry::{Scalar, Vector};

/// The mean velocity of the neighbours that have one, minus the own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlowBlur;

impl FlowResponse for FlowBlur {
    fn name(&self) -> &'static str {
        "flow_blur"
    }

    fn formula(&self) -> &'static str {
        "⟨v₀⟩ − v₀"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        flow.each(|cell, v| {
            let neighbours = moving_neighbours(flow, cell);
            let sum = neighbours.iter().fold(Vector::zeros(), |sum: Vector<S>, &j| sum + flow.velocities[j]);
            let mean = sum * S::constant(1.0 / neighbours.len().max(1) as f64);
            if neighbours.is_empty() { v * S::constant(0.0) } else { (mean - v) * coefficient }
        })
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let Linearisation { flow, jacobian } = at;
        Box::new(move |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            let neighbours = moving_neighbours(flow, cell);
            let share = coefficient / neighbours.len().max(1) as f64;
            for &j in &neighbours {
                row.add_scaled_row(share, jacobian, j);
                row.add_scaled_row(-share, jacobian, cell);
            }
        })
    }
}

/// The neighbours of a cell that have a velocity, one for each side.
fn moving_neighbours<S: Scalar>(flow: &Flow<'_, S>, cell: usize) -> Vec<usize> {
    let neighbours = flow.tessellation.neighbours(cell).iter().map(|&j| j as usize);
    neighbours.filter(|&j| flow.moves(j)).collect()
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "flow_blur",
    formula: "v = v₀ + c (⟨v₀⟩ − v₀)",
    meaning: "The velocity of a cell was measured together with that of its neighbours, as particle image velocimetry does.",
    kind: Kind::Observation,
    parity: Parity::Achiral,
    coefficients: "c",
    unit: Unit { length: 0, time: 0 },
    aliases: &[Alias {
        of: "internal_drag",
        told_apart_by: "tracking of single cells instead of image velocimetry",
    }],
    columns: |_, _| Ok(vec![Column::from(FlowBlur)]),
};
