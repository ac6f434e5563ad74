//! Friction between neighbouring cells.

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{BlockMatrix, Exactness, Flow, FlowResponse, Linearisation, Parity, Stage, assemble};
use std::collections::HashMap;
use voronudge_geometry::{Scalar, Vector};

/// Friction between neighbours, in proportion to the difference of their velocities: `(I + ξ L) v = F` with the graph Laplacian
/// `(L v)_i = Σ_j (v_i − v_j)` over the neighbours that have a velocity. It is symmetric, so momentum is conserved.
///
/// Solved by Chebyshev iteration, whose steps are linear in `F`: derivatives are those of the solution. `ξ` must exceed
/// `−1/(2z)` with the largest number of neighbours `z`; below, the velocities are NaN, because nothing makes them unique.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InternalDrag;

impl FlowResponse for InternalDrag {
    fn name(&self) -> &'static str {
        "internal_drag"
    }

    fn formula(&self) -> &'static str {
        "−ξ L v"
    }

    fn parity(&self) -> Parity {
        Parity::Achiral
    }

    fn conserves_momentum(&self) -> bool {
        true
    }

    fn stage(&self) -> Stage {
        Stage::Implicit
    }

    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
        let graph = Graph::new(flow);
        let mut added = flow.velocities.to_vec();
        for axis in 0..2 {
            let force: Vec<S> = flow.held().iter().map(|v| v[axis]).collect();
            let solution = graph.solve(coefficient, &force);
            for (cell, more) in added.iter_mut().enumerate() {
                more[axis] = solution[cell] - flow.velocities[cell][axis];
            }
        }
        added
    }

    fn linearise(&self, at: &Linearisation<'_>, coefficient: f64) -> BlockMatrix {
        let Linearisation { flow, jacobian } = at;
        let graph = Graph::new(flow);
        let rows = jacobian.rows();
        let first = (0..rows).find(|&cell| flow.moves(cell)).unwrap_or(0);
        let usual = graph.inverse_row(coefficient, first, 1).radius;
        assemble(rows, |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            let InverseRow { cells, weights, .. } = graph.inverse_row(coefficient, cell, usual);
            let largest = largest(&weights);
            for (&j, &weight) in cells.iter().zip(&weights) {
                if weight.abs() > TRUNCATION * largest {
                    row.add_scaled_row(weight, jacobian, j);
                }
            }
            row.add_scaled_row(-1.0, jacobian, cell);
        })
    }

    fn exactness(&self) -> Exactness {
        Exactness::Truncated(TRUNCATION)
    }
}

/// Entries of the inverse that are left out of the Jacobian, relative to the largest of the row.
const TRUNCATION: f64 = 1e-7;

/// Entries of the inverse at which a part of the tissue ends that stands for all of it, in the same unit.
const NEGLIGIBLE: f64 = 1e-9;

/// The reduction of the error at which iteration ends. It is far below rounding, because derivatives converge later.
const REDUCTION: f64 = 1e-20;

/// Largest number of iterations: enough for `ξ` of some thousands.
const MOST_ITERATIONS: usize = 20_000;

/// Who has friction with whom.
struct Graph {
    neighbours: Vec<Vec<u32>>,
    /// Numbers of neighbours that are at rest.
    at_rest: Vec<usize>,
    most: usize,
}

/// A row of the inverse of `I + ξ L`, which is symmetric: the response to a force on one cell.
struct InverseRow {
    /// Cells up to a distance in steps from neighbour to neighbour, by distance.
    cells: Vec<usize>,
    weights: Vec<f64>,
    radius: usize,
}

impl Graph {
    fn new<S: Scalar>(flow: &Flow<'_, S>) -> Self {
        let of = |cell: usize| {
            let all = flow.tessellation.neighbours(cell).iter().copied();
            if flow.moves(cell) { all.filter(|&j| flow.moves(j as usize)).collect() } else { Vec::new() }
        };
        let neighbours: Vec<Vec<u32>> = (0..flow.velocities.len()).map(of).collect();
        let most = neighbours.iter().map(Vec::len).max().unwrap_or(0);
        Self { at_rest: vec![0; neighbours.len()], neighbours, most }
    }

    /// A row, from cells within a radius, larger than the given one where entries at its end are not negligible.
    fn inverse_row(&self, drag: f64, cell: usize, mut radius: usize) -> InverseRow {
        loop {
            let (part, cells, last_ring) = self.around(cell, radius);
            let mut force = vec![0.0; cells.len()];
            force[0] = 1.0;
            let weights = part.solve(drag, &force);
            let largest = largest(&weights);
            if weights[last_ring..].iter().any(|weight| weight.abs() > NEGLIGIBLE * largest) {
                radius += 1;
            } else {
                return InverseRow { cells, weights, radius };
            }
        }
    }

    /// The cells up to a distance from one, by distance, what the graph is among them while all others are at rest, and where the last distance
    /// begins.
    fn around(&self, centre: usize, radius: usize) -> (Self, Vec<usize>, usize) {
        let mut places = HashMap::from([(centre, 0)]);
        let (mut cells, mut ring) = (vec![centre], 0);
        for _ in 0..radius {
            let begin = std::mem::replace(&mut ring, cells.len());
            for k in begin..ring {
                for &next in &self.neighbours[cells[k]] {
                    places.entry(next as usize).or_insert_with(|| {
                        cells.push(next as usize);
                        cells.len() as u32 - 1
                    });
                }
            }
        }
        let among = |cell: &usize| -> Vec<u32> {
            self.neighbours[*cell].iter().filter_map(|next| places.get(&(*next as usize)).copied()).collect()
        };
        let neighbours: Vec<Vec<u32>> = cells.iter().map(among).collect();
        let at_rest = cells
            .iter()
            .zip(&neighbours)
            .map(|(&cell, own)| self.neighbours[cell].len() - own.len())
            .collect();
        (Self { neighbours, at_rest, most: self.most }, cells, ring)
    }

    /// `(I + ξ L) x`
    fn apply<S: Scalar>(&self, drag: S, x: &[S]) -> Vec<S> {
        let row = |((cell, &at_rest), own): ((&Vec<u32>, &usize), &S)| {
            let sum = cell.iter().fold(*own * at_rest as f64, |sum, &j| sum + (*own - x[j as usize]));
            *own + drag * sum
        };
        self.neighbours.iter().zip(&self.at_rest).zip(x).map(row).collect()
    }

    /// The solution of `(I + ξ L) x = f` by Chebyshev iteration on the interval that holds all eigenvalues.
    fn solve<S: Scalar>(&self, drag: S, force: &[S]) -> Vec<S> {
        let end = 1.0 + 2.0 * drag.real() * self.most as f64;
        let (low, high) = (end.min(1.0), end.max(1.0));
        if low <= 0.0 {
            return vec![S::constant(f64::NAN); force.len()];
        }
        let middle = 0.5 * (high + low);
        let half = (0.5 * (high - low)).max(1e-3 * middle);
        let ratio = middle / half;
        let convergence = ratio - (ratio * ratio - 1.0).max(0.0).sqrt();
        let steps = ((REDUCTION.ln() / convergence.ln()).ceil() as usize + 4).min(MOST_ITERATIONS);
        let mut x = force.to_vec();
        let residual =
            |x: &[S]| -> Vec<S> { self.apply(drag, x).iter().zip(force).map(|(ax, f)| *f - *ax).collect() };
        let mut step: Vec<S> = residual(&x).iter().map(|r| *r * (1.0 / middle)).collect();
        let mut rho = 1.0 / ratio;
        for _ in 0..steps {
            for (x, d) in x.iter_mut().zip(&step) {
                *x += *d;
            }
            let next = 1.0 / (2.0 * ratio - rho);
            for (d, r) in step.iter_mut().zip(residual(&x)) {
                *d = *d * (next * rho) + r * (2.0 * next / half);
            }
            rho = next;
        }
        x
    }
}

/// The largest size among numbers.
fn largest(all: &[f64]) -> f64 {
    all.iter().fold(0.0, |largest: f64, one| largest.max(one.abs()))
}

/// The catalogue's entry.
pub(super) const EFFECT: Effect = Effect {
    id: "internal_drag",
    formula: "(I + ξ L) v = F",
    meaning: "Cells drag their neighbours along: friction between cells, not only with the substrate.",
    kind: Kind::Mechanism,
    parity: Parity::Achiral,
    coefficients: "ξ",
    unit: Unit { length: 0, time: 0 },
    aliases: &[Alias {
        of: "flow_blur",
        told_apart_by: "tracking of single cells instead of image velocimetry",
    }],
    columns: |_, _| Ok(vec![Column::from(InternalDrag)]),
};
