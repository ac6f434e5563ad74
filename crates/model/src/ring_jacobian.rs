//! The exact derivative of the ring terms of one cell's element.
//!
//! The forces of a general term are differentiated by dual numbers through the very function that gives them: by the
//! displacements of the ring, or by the position of the cell with the ring held, as far as its [`Reach`] says that they matter. Neither
//! momentum nor translation is taken for granted.

use crate::block_matrix::Block;
use crate::element::ring_terms;
use crate::{CellElement, Environment, Model, Reach, RingForces, WeightedTerm};
use std::sync::Arc;
use voronudge_geometry::{Arithmetic, CellPolygon, Tangent, Tessellation, Vector};

/// By the two coordinates of a point.
type Dual = Tangent<f64, 2>;

/// Buffers for one element after another.
pub(crate) struct RingJacobian {
    environment: Arc<Environment>,
    of_place: Vec<WeightedTerm<Dual>>,
    of_pairs: Vec<WeightedTerm<Dual>>,
    of_ring: Vec<WeightedTerm<Dual>>,
    polygon: CellPolygon<Dual>,
    /// On the cell, then on each of its ring.
    forces: Vec<Vector<Dual>>,
}

impl RingJacobian {
    pub(crate) fn new(model: &Model<f64>) -> Self {
        let lift =
            |w: &WeightedTerm<f64>| WeightedTerm { term: w.term, coefficient: Dual::held(w.coefficient) };
        let of = |reach| {
            model.terms.iter().filter(|w| w.term.reach() == Some(reach)).map(lift).collect::<Vec<_>>()
        };
        Self {
            environment: model.environment.clone(),
            of_place: of(Reach::Place),
            of_pairs: of(Reach::Pair),
            of_ring: of(Reach::Ring),
            polygon: CellPolygon::default(),
            forces: Vec::new(),
        }
    }

    /// Adds the derivatives of the force on the cell, and then on each of its ring, by the position of the cell, and then of each of its ring:
    /// (n + 1)² blocks, row-major.
    pub(crate) fn add(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: usize,
        blocks: &mut [Block],
    ) {
        let Self { environment, of_place, of_pairs, of_ring, polygon, forces } = self;
        let (neighbours, domain, r) = (tessellation.neighbours(cell), tessellation.domain(), positions[cell]);
        let points = neighbours.len() + 1;
        // Gives what the slopes of the forces are to a function, the cell first.
        let mut act = |terms: &[_], polygon: &_, position, add: &mut dyn FnMut(usize, Block)| {
            forces.clear();
            forces.resize(points, Vector::new(Dual::constant(0.0), Dual::constant(0.0)));
            let element = CellElement { cell, neighbours, polygon, position, domain, environment };
            if let Some((on_cell, on_ring)) = forces.split_first_mut() {
                ring_terms(terms, &element, &mut RingForces { on_ring, on_cell });
            }
            forces.iter().enumerate().for_each(|(point, force)| add(point, Dual::block(force)));
        };
        let ring = || tessellation.displacements(positions, cell);
        // A displacement of the ring grows with its neighbour's position and falls with the cell's; that of an image of the cell stays.
        let moves = |m: usize| neighbours[m] as usize != cell;
        let mut to = |row: usize, column: usize, block: Block, sign: f64| {
            let total = &mut blocks[row * points + column];
            total.iter_mut().zip(block).for_each(|(total, entry)| *total += sign * entry);
        };
        if !of_place.is_empty() {
            polygon.fill_ring(ring().map(Dual::held_vector));
            act(of_place, polygon, Dual::seeded_vector(r), &mut |row, block| to(row, 0, block, 1.0));
        }
        if !of_pairs.is_empty() {
            // No force depends on more than its own pair, so all pairs move at once.
            polygon.fill_ring(ring().map(Dual::seeded_vector));
            act(of_pairs, polygon, Dual::held_vector(r), &mut |other, block| {
                if other > 0 && moves(other - 1) {
                    to(other, other, block, 1.0);
                    to(other, 0, block, -1.0);
                    to(0, other, block, -1.0);
                    to(0, 0, block, 1.0);
                }
            });
        }
        if !of_ring.is_empty() {
            polygon.fill_ring(ring().map(Dual::held_vector));
            for (m, displacement) in ring().enumerate().filter(|(m, _)| moves(*m)) {
                polygon.with_neighbour(m, Dual::seeded_vector(displacement), |polygon| {
                    act(of_ring, polygon, Dual::held_vector(r), &mut |row, block| {
                        to(row, m + 1, block, 1.0);
                        to(row, 0, block, -1.0);
                    });
                });
            }
        }
    }
}
