//! Variances: of the velocities, and of the parameters of the cells, at a given spring.
//!
//! With the unknowns u of variance `s_q²`, velocities of variance σ_v² and D = diag(s_q / σ_v), B = I + D ZᵀPZ D, restricted maximum
//! likelihood is least in
//!
//! ```text
//! −2 log L = (n − p) log σ_v² + log det W + log det XᵀW⁻¹X + log det B + (yᵀPy − yᵀPZ D B⁻¹ D ZᵀPy) / σ_v²
//! ```

use super::gram::Projected;
use super::inverse::inverse;
use crate::Error;
use crate::noise::SMALLEST_VELOCITY_NOISE;
use crate::own_parts::Layout;
use nalgebra::{DMatrix, DVector};

/// Standard deviations below this, relative to the parameter, are none.
pub(super) const SMALLEST: f64 = 1e-3;

/// Largest step in a log variance.
const LARGEST_STEP: f64 = 1.5;

/// Change of −2 log L that counts as none.
const SETTLED: f64 = 5e-3;

/// Steps at most.
const STEPS: usize = 12;

/// log σ_v² and log s_q²; `None` for parameters in which cells do not differ.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variances {
    pub velocity: f64,
    pub of_cells: Vec<Option<f64>>,
}

impl Variances {
    /// s_q²/σ_v²
    pub fn ratio(&self, parameter: usize) -> f64 {
        self.of_cells[parameter].map_or(0.0, |own| (own - self.velocity).exp())
    }

    /// s_q/σ_v of each unknown.
    pub fn roots(&self, layout: &Layout) -> DVector<f64> {
        DVector::from_fn(layout.order(), |i, _| self.ratio(i / layout.cells).sqrt())
    }
}

/// Which variances stay as they are.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Held {
    pub velocity: bool,
    /// The parameter whose spread is held.
    pub parameter: Option<usize>,
}

/// The restricted likelihood at one spring.
pub(super) struct Likelihood<'a> {
    pub layout: &'a Layout,
    pub products: &'a Projected,
    /// n − p
    pub left: f64,
}

/// −2 log L with its derivatives by log σ_v² and those log s_q² that are not `None`.
struct Local {
    criterion: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl Likelihood<'_> {
    /// The unknowns whose variance is not nought.
    fn active(&self, at: &Variances) -> Vec<usize> {
        (0..self.layout.order()).filter(|i| at.of_cells[i / self.layout.cells].is_some()).collect()
    }

    /// B over the active unknowns, and D ZᵀPy.
    fn scaled(&self, at: &Variances, active: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let roots = at.roots(self.layout);
        let of_cells = &self.products.of_cells;
        let scaled = DMatrix::from_fn(active.len(), active.len(), |i, j| {
            let (a, b) = (active[i], active[j]);
            roots[a] * of_cells[(a, b)] * roots[b] + if i == j { 1.0 } else { 0.0 }
        });
        (scaled, DVector::from_fn(active.len(), |i, _| roots[active[i]] * self.products.data[active[i]]))
    }

    /// −2 log L, up to a constant, from log det B and what the deviations explain.
    fn of(&self, at: &Variances, log_determinant: f64, explained: f64) -> f64 {
        let misfit = self.products.misfit - explained;
        self.left * at.velocity + self.products.log_determinant + log_determinant + misfit / at.velocity.exp()
    }

    fn local(&self, at: &Variances) -> Result<Local, Error> {
        let active = self.active(at);
        let (scaled, data) = self.scaled(at, &active);
        let (inverse, log_determinant) = inverse(&scaled)?;
        let solved = &inverse * &data;
        let explained = data.dot(&solved);
        let variance = at.velocity.exp();
        let shown: Vec<usize> = (0..at.of_cells.len()).filter(|q| at.of_cells[*q].is_some()).collect();
        let cells = self.layout.cells;
        let (mut gradient, mut hessian) =
            (DVector::zeros(shown.len() + 1), DMatrix::zeros(shown.len() + 1, shown.len() + 1));
        let mut left = self.left;
        let mut misfit = (self.products.misfit - explained) / variance;
        for k in 0..shown.len() {
            let own = k * cells;
            let trace = cells as f64 - inverse.view((own, own), (cells, cells)).trace();
            let squares = solved.rows(own, cells).norm_squared() / variance;
            gradient[k + 1] = trace - squares;
            left -= trace;
            misfit -= squares;
            hessian[(0, k + 1)] += trace;
            for l in 0..shown.len() {
                let block = inverse.view((own, l * cells), (cells, cells));
                let unit = if k == l { cells as f64 - 2.0 * block.trace() } else { 0.0 };
                let product = unit + block.norm_squared();
                hessian[(k + 1, l + 1)] = product;
                hessian[(0, k + 1)] -= product;
                hessian[(0, 0)] += product;
            }
            hessian[(k + 1, 0)] = hessian[(0, k + 1)];
            hessian[(0, 0)] -= 2.0 * trace;
        }
        hessian[(0, 0)] += self.left;
        gradient[0] = left - misfit;
        Ok(Local { criterion: self.of(at, log_determinant, explained), gradient, hessian })
    }

    /// The most likely variances near some, by Fisher's method, and their −2 log L. A spread that becomes negligible is none.
    pub fn most_likely(&self, start: &Variances, held: Held) -> Result<(Variances, f64), Error> {
        let least = 2.0 * SMALLEST_VELOCITY_NOISE.ln();
        let mut at = start.clone();
        if !held.velocity {
            at.velocity = at.velocity.max(least);
        }
        let mut here = self.local(&at)?;
        for _ in 0..STEPS {
            let shown: Vec<usize> = (0..at.of_cells.len()).filter(|q| at.of_cells[*q].is_some()).collect();
            let free: Vec<usize> = (0..=shown.len())
                .filter(|k| match k {
                    // Data without errors would have none.
                    0 => !held.velocity && (at.velocity > least || here.gradient[0] < 0.0),
                    k => held.parameter != Some(shown[k - 1]),
                })
                .collect();
            let mut hessian =
                DMatrix::from_fn(free.len(), free.len(), |i, j| here.hessian[(free[i], free[j])]);
            let gradient = DVector::from_fn(free.len(), |i, _| here.gradient[free[i]]);
            for i in 0..free.len() {
                hessian[(i, i)] *= 1.0 + 1e-9;
                hessian[(i, i)] += 1e-9;
            }
            let step = hessian.cholesky().ok_or(Error::Degenerate)?.solve(&gradient);
            let mut scale = 1.0;
            let mut gained = 0.0;
            for _ in 0..8 {
                let mut next = at.clone();
                for (i, k) in free.iter().enumerate() {
                    let change = (-scale * step[i]).clamp(-LARGEST_STEP, LARGEST_STEP);
                    match k {
                        0 => next.velocity = (next.velocity + change).max(least),
                        k => next.of_cells[shown[k - 1]] = next.of_cells[shown[k - 1]].map(|v| v + change),
                    }
                }
                for (q, own) in next.of_cells.iter_mut().enumerate() {
                    if held.parameter != Some(q) && own.is_some_and(|v| v < 2.0 * SMALLEST.ln()) {
                        *own = None;
                    }
                }
                let there = self.local(&next)?;
                if there.criterion < here.criterion + SETTLED {
                    gained = here.criterion - there.criterion;
                    (at, here) = (next, there);
                    break;
                }
                scale *= 0.5;
            }
            if gained < SETTLED {
                break;
            }
        }
        Ok((at, here.criterion))
    }
}
