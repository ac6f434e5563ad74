//! The exact derivative of the ring terms of one cell's element.
//!
//! The forces of a general term are differentiated by dual numbers through the very function that gives them: by the
//! displacements of the ring and, for terms that depend on where the cell is, by its position with the ring held. Neither
//! momentum nor translation is taken for granted.

use crate::assembly::ring_terms;
use crate::block_matrix::Block;
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

    /// Adds the derivatives of the force on the cell, and then on each of its ring, by the position of the cell, and then of each of its ring:
    /// (n + 1)² blocks, row-major.
    pub(crate) fn add(
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
            // The cell comes last among the points here, and first among the blocks.
            let (on_cell, on_ring) = blocks.split_at_mut(points);
            let rows = on_ring.chunks_exact_mut(points).chain(std::iter::once(on_cell));
            for (row, force) in rows.zip(&self.forces) {
                for (k, point) in (first..points).take(POINTS).enumerate() {
                    let slope = |x: &Dual, along: usize| x.eps.0.map_or(0.0, |eps| eps[2 * k + along]);
                    let block =
                        [slope(&force.x, 0), slope(&force.x, 1), slope(&force.y, 0), slope(&force.y, 1)];
                    if point + 1 == points {
                        row[0].iter_mut().zip(block).for_each(|(total, entry)| *total += entry);
                    } else if tessellation.neighbours(cell)[point] as usize != cell {
                        // A displacement of the ring grows with its neighbour's position and falls with the cell's; that of an image of the cell stays.
                        row[point + 1].iter_mut().zip(block).for_each(|(total, entry)| *total += entry);
                        row[0].iter_mut().zip(block).for_each(|(total, entry)| *total -= entry);
                    }
                }
            }
        }
    }
}
