//! Velocities under a whole model: those of its terms, and what its responses make of them.

use crate::response::respond;
use crate::{HalfEdgeForces, Model, VelocityAssembly};
use voronudge_geometry::{Scalar, Tessellation, Vector};

impl<S: Scalar> VelocityAssembly<S> {
    /// Evaluates all elements, sums them into velocities (N) and lets the responses act on these.
    pub fn evaluate(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<S>],
        model: &Model<S>,
        velocities: &mut Vec<Vector<S>>,
    ) {
        self.evaluate_terms(tessellation, positions, model, velocities);
        respond(tessellation, positions, model, velocities);
    }
}

impl<S: Scalar> HalfEdgeForces<S> {
    /// As [`VelocityAssembly::evaluate`], and keeps the forces. Those of a cell whose polygon is not closed are NaN. Responses add no forces.
    pub fn evaluate(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<S>],
        model: &Model<S>,
        velocities: &mut Vec<Vector<S>>,
    ) {
        velocities.resize(tessellation.len(), Vector::new(S::constant(0.0), S::constant(0.0)));
        self.evaluate_with_images(tessellation, positions, model, &[], velocities);
        respond(tessellation, positions, model, velocities);
    }
}

/// Velocities of all cells (N) under a model.
///
/// In an open field of view the velocity is NaN for cells that have an open polygon or such a neighbour.
pub fn velocities<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    model: &Model<S>,
) -> Vec<Vector<S>> {
    let mut v = Vec::new();
    VelocityAssembly::default().evaluate(tessellation, positions, model, &mut v);
    v
}
