//! The exact derivative of the ring terms of one cell's element.
//!
//! The forces of a general term are differentiated by dual numbers through the very function that gives them: by the
//! displacements of the ring and, for terms that depend on where the cell is, by its position with the ring held. Neither
//! momentum nor translation is taken for granted.

use crate::assembly::ring_terms;
use crate::element_jacobian::Block;
use crate::{CellElement, Model, RingForces};
use num_dual::DualSVec64;
use voronudge_geometry::{Arithmetic, CellPolygon, Tessellation, Vector};

/// Points of the plane by which forces are differentiated at once.
const POINTS: usize = 4;
type Dual = DualSVec64<{ 2 * POINTS }>;

/// Buffers for one element after another.
pub(crate) struct RingJacobian {
    model: Model<Dual>,
    ring: Vec<Vector<f64>>,
    polygon: CellPolygon<Dual>,
    forces: Vec<Vector<Dual>>,
}

impl RingJacobian {
    pub(crate) fn new(model: &Model<f64>) -> Self {
        let mut model = model.lift();
        model.terms.retain(|w| w.term.is_ring_term());
        Self { model, ring: Vec::new(), polygon: CellPolygon::default(), forces: Vec::new() }
    }

    /// Fills the derivative of each force on the ring, and of that on the cell in the last row, by each displacement of
    /// the ring, and by the position of the cell in the last column: (n + 1)² blocks, row-major.
    pub(crate) fn fill(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: usize,
        blocks: &mut [Block],
    ) {
        self.ring.clear();
        self.ring.extend(tessellation.ring(cell).map(|h| tessellation.displacement(positions, cell, h)));
        let points = self.ring.len() + 1;
        for first in (0..points).step_by(POINTS) {
            let seed = |point: usize, v: Vector<f64>| {
                let (x, y) = (Dual::from_re(v.x), Dual::from_re(v.y));
                match point.checked_sub(first).filter(|k| *k < POINTS) {
                    Some(k) => Vector::new(x.derivative(2 * k), y.derivative(2 * k + 1)),
                    None => Vector::new(x, y),
                }
            };
            self.polygon.fill_ring(self.ring.iter().enumerate().map(|(m, d)| seed(m, *d)));
            let zero = Vector::new(Dual::constant(0.0), Dual::constant(0.0));
            self.forces.clear();
            self.forces.resize(points, zero);
            let element = CellElement {
                cell,
                neighbours: tessellation.neighbours(cell),
                polygon: &self.polygon,
                position: seed(points - 1, positions[cell]),
                domain: tessellation.domain(),
                environment: &self.model.environment,
            };
            if let Some((on_cell, on_ring)) = self.forces.split_last_mut() {
                ring_terms(&self.model, &element, &mut RingForces { on_ring, on_cell });
            }
            for (row, force) in blocks.chunks_exact_mut(points).zip(&self.forces) {
                for (k, block) in row.iter_mut().skip(first).take(POINTS).enumerate() {
                    let slope = |x: &Dual, along: usize| x.eps.0.map_or(0.0, |eps| eps[2 * k + along]);
                    *block = [slope(&force.x, 0), slope(&force.x, 1), slope(&force.y, 0), slope(&force.y, 1)];
                }
            }
        }
    }
}
