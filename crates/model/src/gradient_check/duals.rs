//! Dual numbers through the whole system, without any use of its sparsity.

use super::{Axis, Comparison, Pair, Place, Subject, cell_energy};
use crate::{Model, velocities};
use num_dual::DualSVec64;
use rayon::prelude::*;
use voronudge_geometry::{CellPolygon, Scalar, Tessellation, Vector, lift};

/// Cells differentiated at once.
const CELLS: usize = 4;

/// A number with its derivatives along both coordinates of each of these cells.
type Dual = DualSVec64<{ 2 * CELLS }>;

fn seeded(positions: &[Vector<f64>], cells: &[usize]) -> Vec<Vector<Dual>> {
    let mut dual: Vec<Vector<Dual>> = lift(positions);
    for (k, &cell) in cells.iter().enumerate() {
        for axis in Axis::BOTH {
            let at = axis.index();
            dual[cell][at] = Dual::from_re(positions[cell][at]).derivative(2 * k + at);
        }
    }
    dual
}

fn derivative(dual: &Dual, k: usize, axis: Axis) -> f64 {
    dual.eps.0.map_or(0.0, |eps| eps[2 * k + axis.index()])
}

/// The sparse Jacobian against the derivative of all velocities, zeros included.
pub(super) fn jacobian(subject: &Subject) -> Comparison {
    let sample = subject.sample;
    let model: Model<Dual> = subject.model.lift();
    let batches: Vec<&[usize]> = subject.displaced.chunks(CELLS).collect();
    let compared: Vec<Comparison> = batches
        .into_par_iter()
        .map(|batch| {
            let v = velocities(&sample.tessellation, &seeded(&sample.positions, batch), &model);
            let mut comparison = Comparison::new();
            for cell in (0..v.len()).filter(|&cell| subject.moves(cell)) {
                let mut blocks = [[0.0; 4]; CELLS];
                for (column, block) in subject.jacobian.row(cell) {
                    if let Some(k) = batch.iter().position(|&by| by == column) {
                        blocks[k] = *block;
                    }
                }
                for (k, &by) in batch.iter().enumerate() {
                    for (axis, along) in Axis::BOTH.into_iter().flat_map(|a| Axis::BOTH.map(|b| (a, b))) {
                        let found = blocks[k][2 * axis.index() + along.index()];
                        let expected = derivative(&v[cell][axis.index()], k, along);
                        comparison.add(found, expected, || Place::Entry { cell, axis, by, along });
                    }
                }
            }
            comparison
        })
        .collect();
    compared.into_iter().fold(subject.of_slopes(), Comparison::and)
}

/// Velocities against the gradient of the total energy of all closed cells.
pub(super) fn energy(subject: &Subject) -> Comparison {
    let sample = subject.sample;
    let model: Model<Dual> = subject.model.lift();
    let cells: Vec<usize> = subject.displaced.iter().copied().filter(|&cell| subject.moves(cell)).collect();
    let batches: Vec<&[usize]> = cells.chunks(CELLS).collect();
    let gradients: Vec<Dual> = (batches.par_iter())
        .map(|batch| total_energy(&sample.tessellation, &seeded(&sample.positions, batch), &model))
        .collect();
    let mut pairs = Vec::with_capacity(cells.len());
    for (batch, energy) in batches.iter().zip(&gradients) {
        for (k, &cell) in batch.iter().enumerate() {
            let gradient = Vector::from(Axis::BOTH.map(|axis| derivative(energy, k, axis)));
            pairs.push(Pair { cell, found: subject.velocities[cell], expected: -gradient });
        }
    }
    subject.compare(sample.widest, &pairs)
}

fn total_energy<S: Scalar>(tessellation: &Tessellation, positions: &[Vector<S>], model: &Model<S>) -> S {
    let mut polygon = CellPolygon::default();
    let mut sum = S::constant(0.0);
    for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell)) {
        polygon.fill(tessellation, positions, cell);
        sum += cell_energy(model, polygon.shape());
    }
    sum
}
