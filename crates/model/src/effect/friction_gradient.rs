//! Friction that changes across the tissue.

use super::{Column, Effect, Kind, Profile, Unit};
use crate::{Flow, FlowResponse, Linearisation, Parity, Rows};
use voronudge_geometry::{Scalar, Tangent, Vector};

/// Friction with the substrate proportional to a profile over position, to first order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionGradient {
    /// Its dependence on position.
    pub profile: Profile,
}

impl FlowResponse for FrictionGradient {
    fn name(&self) -> &'static str {
        "friction_gradient"
    }

    fn formula(&self) -> &'static str {
        "−x_k v₀"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        let origin = flow.model.environment.origin();
        flow.each(|cell, v| {
            let r = flow.positions[cell];
            v * (-coefficient * self.profile.at(Vector::new(r.x - origin.x, r.y - origin.y)))
        })
    }

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let Linearisation { flow, jacobian } = at;
        Box::new(move |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            let (r, v) = (flow.positions[cell] - flow.model.environment.origin(), flow.velocities[cell]);
            let profile = self.profile.at(Tangent::seeded_vector(r));
            row.add_scaled_row(-coefficient * profile.value, jacobian, cell);
            let [x, y] = profile.slopes.map(|slope| -coefficient * slope);
            row.add(cell, &[v.x * x, v.x * y, v.y * x, v.y * y]);
        })
    }
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "friction_gradient",
    formula: "v = v₀ − Σ c_k x_k v₀",
    meaning: "Cells stick more strongly to the substrate on one side of the tissue than on the other.",
    kind: Kind::Mechanism,
    parity: Parity::Oriented,
    coefficients: "one for each profile: 2 in an open field, 4 in a box",
    unit: Unit { length: -1, time: 0 },
    aliases: &[],
    columns: |_, domain| {
        Ok(Profile::ramps(domain).map(|profile| Column::from(FrictionGradient { profile })).collect())
    },
};
