//! From elements to the velocities of all cells.
//!
//! Each element writes the forces on its ring into its own half-edges; each cell then gathers what its neighbours wrote
//! about it, in the order of its ring. No two threads write to one place and no sum depends on their number.

use crate::{Model, Term, VertexForces, WeightedTerm};
use rayon::prelude::*;
use voronudge_geometry::{CellPolygon, Scalar, Tessellation, Vector};

/// Cells per task.
pub(crate) const CHUNK: usize = 1024;

/// Forces of every cell on its neighbours, one per half-edge. Reusable from call to call.
#[derive(Debug, Clone)]
pub struct HalfEdgeForces<S> {
    forces: Vec<Vector<S>>,
}

impl<S: Scalar> Default for HalfEdgeForces<S> {
    fn default() -> Self {
        Self { forces: Vec::new() }
    }
}

impl<S: Scalar> HalfEdgeForces<S> {
    /// Evaluates all elements. The forces of a cell whose polygon is not closed are NaN.
    pub fn evaluate(&mut self, tessellation: &Tessellation, positions: &[Vector<S>], model: &Model<S>) {
        let nan = S::constant(f64::NAN);
        self.forces.resize(tessellation.half_edges(), Vector::new(nan, nan));
        let cells = tessellation.len();
        if cells <= CHUNK {
            elements(tessellation, positions, &model.terms, 0..cells, &mut self.forces);
            return;
        }
        let mut rest = self.forces.as_mut_slice();
        let mut tasks = Vec::with_capacity(cells.div_ceil(CHUNK));
        for first in (0..cells).step_by(CHUNK) {
            let last = (first + CHUNK).min(cells);
            let (own, after) =
                rest.split_at_mut(tessellation.ring(last - 1).end - tessellation.ring(first).start);
            rest = after;
            tasks.push((first..last, own));
        }
        tasks
            .into_par_iter()
            .for_each(|(range, own)| elements(tessellation, positions, &model.terms, range, own));
    }

    /// The force of the half-edge's cell on the neighbour it points at.
    #[inline]
    pub fn on_neighbour(&self, half_edge: usize) -> Vector<S> {
        self.forces[half_edge]
    }

    /// Sums the forces into velocities (N).
    pub fn gather(&self, tessellation: &Tessellation, velocities: &mut Vec<Vector<S>>) {
        let zero = S::constant(0.0);
        velocities.resize(tessellation.len(), Vector::new(zero, zero));
        velocities.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(cell, v)| {
            let mut sum = Vector::new(zero, zero);
            for h in tessellation.ring(cell) {
                sum += self.forces[tessellation.twin(h)] - self.forces[h];
            }
            *v = sum;
        });
    }
}

fn elements<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    terms: &[WeightedTerm<S>],
    cells: std::ops::Range<usize>,
    forces: &mut [Vector<S>],
) {
    let mut polygon = CellPolygon::default();
    let offset = tessellation.ring(cells.start).start;
    for cell in cells {
        let ring = tessellation.ring(cell);
        let own = &mut forces[ring.start - offset..ring.end - offset];
        if tessellation.is_closed(cell) {
            polygon.fill(tessellation, positions, cell);
            VertexForces::of(terms, polygon.shape()).on_ring(&polygon, own);
        } else {
            let nan = S::constant(f64::NAN);
            own.fill(Vector::new(nan, nan));
        }
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
    let mut forces = HalfEdgeForces::default();
    forces.evaluate(tessellation, positions, model);
    let mut v = Vec::new();
    forces.gather(tessellation, &mut v);
    v
}

/// The velocity field of each term for a coefficient of one: velocities are linear in the coefficients.
pub fn columns(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    terms: &[Term],
) -> Vec<Vec<Vector<f64>>> {
    terms.iter().map(|&term| velocities(tessellation, positions, &Model::single(term))).collect()
}
