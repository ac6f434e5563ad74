//! Friction between neighbouring cells.

mod inverse_rows;

use super::{Alias, Column, Effect, Kind, Unit};
use crate::{Exactness, Flow, FlowResponse, Linearisation, Parity, Rows, Stage};
use inverse_rows::inverse_rows;
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

    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
        let Linearisation { flow, jacobian } = at;
        let graph = Graph::new(flow);
        let inverse = inverse_rows(&graph, coefficient);
        Box::new(move |cell, row| {
            if !flow.moves(cell) {
                return;
            }
            for &(other, weight) in &inverse[cell] {
                row.add_scaled_row(weight, jacobian, other as usize);
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

/// The reduction of the error at which iteration ends. It is far below rounding, because derivatives converge later.
const REDUCTION: f64 = 1e-20;

/// Largest number of iterations: enough for `ξ` of some thousands.
const MOST_ITERATIONS: usize = 20_000;

/// Who has friction with whom.
struct Graph {
    neighbours: Vec<Vec<u32>>,
    most: usize,
}

impl Graph {
    fn new<S: Scalar>(flow: &Flow<'_, S>) -> Self {
        let of = |cell: usize| {
            let all = flow.tessellation.neighbours(cell).iter().copied();
            if flow.moves(cell) { all.filter(|&j| flow.moves(j as usize)).collect() } else { Vec::new() }
        };
        let neighbours: Vec<Vec<u32>> = (0..flow.velocities.len()).map(of).collect();
        let most = neighbours.iter().map(Vec::len).max().unwrap_or(0);
        Self { neighbours, most }
    }

    /// `(I + ξ L) x`
    fn apply<S: Scalar>(&self, drag: S, x: &[S]) -> Vec<S> {
        let row = |(cell, own): (&Vec<u32>, &S)| {
            let sum = cell.iter().fold(S::constant(0.0), |sum, &j| sum + (*own - x[j as usize]));
            *own + drag * sum
        };
        self.neighbours.iter().zip(x).map(row).collect()
    }

    /// The solution of `(I + ξ L) x = f` by Chebyshev iteration on the interval that holds all eigenvalues.
    fn solve<S: Scalar>(&self, drag: S, force: &[S]) -> Vec<S> {
        let Some(Chebyshev { middle, half, convergence }) = Chebyshev::new(drag.real(), self.most) else {
            return vec![S::constant(f64::NAN); force.len()];
        };
        let ratio = middle / half;
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

/// The interval that holds all eigenvalues of `I + ξ L`, and by how much a step of the iteration reduces errors.
struct Chebyshev {
    middle: f64,
    half: f64,
    convergence: f64,
}

impl Chebyshev {
    /// For a graph with at most so many neighbours; `None` where the interval holds zero.
    fn new(drag: f64, most: usize) -> Option<Self> {
        let end = 1.0 + 2.0 * drag * most as f64;
        let (low, high) = (end.min(1.0), end.max(1.0));
        if low <= 0.0 {
            return None;
        }
        let middle = 0.5 * (high + low);
        let half = (0.5 * (high - low)).max(1e-3 * middle);
        let ratio = middle / half;
        Some(Self { middle, half, convergence: ratio - (ratio * ratio - 1.0).max(0.0).sqrt() })
    }
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
