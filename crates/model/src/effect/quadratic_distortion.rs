//! Second-order polynomials of the position: the error of a lens.

use super::{Column, Effect, Kind, Unit, open_only};
use crate::{Axis, CellElement, ForceTerm, Parity, Reach, RingForces, RingTerm};
use voronudge_geometry::{Elementary, Vector};

/// A monomial of the position about the origin, in units of `ℓ_0`, as a velocity along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolynomialFlow {
    /// Direction of the velocity.
    pub axis: Axis,
    /// Powers of x and of y.
    pub powers: [u8; 2],
}

impl Default for PolynomialFlow {
    fn default() -> Self {
        Self { axis: Axis::X, powers: [2, 0] }
    }
}

impl ForceTerm for PolynomialFlow {
    fn name(&self) -> &'static str {
        "polynomial_flow"
    }

    fn formula(&self) -> &'static str {
        "ê x^a y^b / ℓ_0^(a + b)"
    }

    fn parity(&self) -> Parity {
        Parity::Oriented
    }

    fn conserves_momentum(&self) -> bool {
        false
    }
}

impl RingTerm for PolynomialFlow {
    fn reach(&self) -> Reach {
        Reach::Place
    }

    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>) {
        let x = cell.from_origin() * S::constant(1.0 / cell.environment.cell_size());
        let [a, b] = self.powers.map(u32::from);
        let mut velocity = Vector::new(S::constant(0.0), S::constant(0.0));
        velocity[self.axis.index()] = coefficient * x.x.power(a) * x.y.power(b);
        forces.on_cell(velocity);
    }
}

/// Monomials of the given total powers, as velocities along both axes.
pub(super) fn monomials(orders: std::ops::RangeInclusive<u8>) -> Vec<Column> {
    let powers = orders.flat_map(|order| (0..=order).map(move |b| [order - b, b]));
    powers.flat_map(|powers| Axis::BOTH.map(|axis| Column::from(PolynomialFlow { axis, powers }))).collect()
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "quadratic_distortion",
    formula: "v = Σ c x^a y^b / ℓ_0², a + b = 2",
    meaning: "The image is distorted by the optics, or a flow bends across the field.",
    kind: Kind::Observation,
    parity: Parity::Oriented,
    coefficients: "six: x², xy, y² for each component",
    unit: Unit { length: 1, time: -1 },
    aliases: &[],
    columns: |_, domain| {
        open_only(domain)?;
        Ok(monomials(2..=2))
    },
};
