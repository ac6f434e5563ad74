//! Central differences of sixth order.

use super::sample::Batch;
use super::{Axis, Comparison, GradientRow, Pair, Place, Quantity, Subject, cell_energy};
use crate::{Model, PARAMETER_NAMES, Parameters, parameter_derivatives, velocities};
use rayon::prelude::*;
use voronudge_geometry::{CellPolygon, Vector};

/// `f′(0) h = Σ_k w_k (f(k h) − f(−k h)) + O(h⁷)`
const WEIGHTS: [(f64, f64); 3] = [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)];

/// The sparse Jacobian against differences of the velocities, at frozen topology.
pub(super) fn jacobian(subject: &Subject) -> Comparison {
    let batches = match subject.model.responses.is_empty() {
        true => subject.sample.batches(&subject.displaced),
        false => subject.sample.single(&subject.displaced),
    };
    let tasks: Vec<(&Batch, Axis)> = batches.iter().flat_map(|b| Axis::BOTH.map(|axis| (b, axis))).collect();
    let compared: Vec<Comparison> =
        tasks.into_par_iter().map(|(batch, along)| displaced(subject, batch, along)).collect();
    compared.into_iter().fold(subject.of_slopes(), Comparison::and)
}

fn displaced(subject: &Subject, batch: &Batch, along: Axis) -> Comparison {
    let sample = subject.sample;
    let mut direction = vec![Vector::zeros(); sample.positions.len()];
    for &cell in &batch.cells {
        direction[cell][along.index()] = sample.step[cell];
    }
    let velocities_at = |factor: f64| {
        let moved: Vec<_> = sample.positions.iter().zip(&direction).map(|(r, d)| r + d * factor).collect();
        velocities(&sample.tessellation, &moved, &subject.model)
    };
    let mut difference = vec![Vector::zeros(); sample.positions.len()];
    for (factor, weight) in WEIGHTS {
        let (after, before) = (velocities_at(factor), velocities_at(-factor));
        for (sum, (after, before)) in difference.iter_mut().zip(after.iter().zip(&before)) {
            *sum += (after - before) * weight;
        }
    }
    let mut comparison = Comparison::new();
    let predicted = subject.jacobian.apply(&direction);
    for (cell, by) in batch.moved_by.iter().enumerate() {
        if let Some(by) = by.filter(|_| subject.moves(cell)) {
            let scale = 1.0 / sample.step[by];
            comparison.add_vector(predicted[cell] * scale, difference[cell] * scale, |axis| Place::Entry {
                cell,
                axis,
                by,
                along,
            });
        }
    }
    comparison
}

/// Velocities against differences of the energies of a cell and its neighbours.
pub(super) fn energy(subject: &Subject) -> Comparison {
    let sample = subject.sample;
    let cells: Vec<usize> = sample.resolved(&subject.displaced).filter(|&cell| subject.moves(cell)).collect();
    let gradients: Vec<Vector<f64>> = cells
        .par_iter()
        .map(|&cell| Vector::from(Axis::BOTH.map(|axis| slope(subject, cell, axis))))
        .collect();
    let pairs: Vec<Pair> = (cells.iter().zip(&gradients))
        .map(|(&cell, gradient)| Pair { cell, found: subject.velocities[cell], expected: -gradient })
        .collect();
    subject.compare(sample.widest, &pairs)
}

/// `∂E/∂r` along one axis: only the energies of the cell and its neighbours change.
fn slope(subject: &Subject, cell: usize, axis: Axis) -> f64 {
    let sample = subject.sample;
    let mut changed: Vec<usize> = sample.tessellation.neighbours(cell).iter().map(|&k| k as usize).collect();
    changed.push(cell);
    changed.sort_unstable();
    changed.dedup();
    let mut moved = sample.positions.clone();
    let mut polygon = CellPolygon::default();
    let mut energies_at = |factor: f64| -> Vec<f64> {
        moved[cell] = sample.positions[cell];
        moved[cell][axis.index()] += factor * sample.step[cell];
        let mut energy = |k: &usize| {
            polygon.fill(&sample.tessellation, &moved, *k);
            cell_energy(&subject.model, polygon.shape())
        };
        changed.iter().map(&mut energy).collect()
    };
    let mut difference = 0.0;
    for (factor, weight) in WEIGHTS {
        let (after, before) = (energies_at(factor), energies_at(-factor));
        difference += weight * after.iter().zip(&before).map(|(a, b)| a - b).sum::<f64>();
    }
    difference / sample.step[cell]
}

/// The derivatives of the base model by its parameters. Velocities are linear in each, so the step may be large.
pub(super) fn parameters(subject: &Subject, parameters: &Parameters<f64>) -> Vec<GradientRow> {
    let sample = subject.sample;
    let exact = parameter_derivatives(&sample.tessellation, &sample.positions, parameters);
    parameters_against(subject, parameters, &exact)
}

/// The same for given derivatives.
pub(super) fn parameters_against(
    subject: &Subject,
    parameters: &Parameters<f64>,
    exact: &[Vec<Vector<f64>>; PARAMETER_NAMES.len()],
) -> Vec<GradientRow> {
    let sample = subject.sample;
    let fields: [fn(&mut Parameters<f64>) -> &mut f64; PARAMETER_NAMES.len()] = [
        |p| &mut p.area_elasticity,
        |p| &mut p.perimeter_elasticity,
        |p| &mut p.preferred_perimeter,
        |p| &mut p.chirality,
    ];
    let mut rows = Vec::new();
    for ((name, field), exact) in PARAMETER_NAMES.into_iter().zip(fields).zip(exact) {
        let step = field(&mut { *parameters }).abs().max(1.0);
        let velocities_at = |shift: f64| {
            let mut shifted = *parameters;
            *field(&mut shifted) += shift;
            velocities(&sample.tessellation, &sample.positions, &Model::chiral_voronoi(&shifted))
        };
        let (after, before) = (velocities_at(step), velocities_at(-step));
        let pair = |cell: usize| Pair {
            cell,
            found: exact[cell],
            expected: (after[cell] - before[cell]) / (2.0 * step),
        };
        let moving = (0..sample.positions.len()).filter(|&cell| subject.moves(cell));
        let comparison = subject.compare(sample.widest, &moving.map(pair).collect::<Vec<_>>());
        rows.extend(comparison.row(subject.name, Quantity::ParameterDerivative(name)));
    }
    rows
}
