//! Normal equations of one frame, linearised about the current nudges and coefficients.
//!
//! With r = v − F, J = ∂F/∂ε and X = ∂F/∂β, a damped Gauss–Newton step solves
//!
//! ```text
//! [ JᵀJ + (k+λ)I   JᵀX ] [δε]   [ Jᵀr − kε ]
//! [ XᵀJ            XᵀX ] [δβ] = [ Xᵀr      ]
//! ```
//!
//! The sparse block is factorised; the few coefficients follow from the Schur complement, summed over frames.

use crate::Error;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_linalg::{Cholesky, CholeskyPattern, SymmetricMatrix};
use voronudge_model::BlockMatrix;

/// Block columns of JᵀJ per task.
const CHUNK: usize = 256;

/// The linearised problem of one frame.
pub(crate) struct Linearisation {
    normal: SymmetricMatrix,
    pattern: CholeskyPattern,
    /// JᵀX (2N × p, by columns), then the gradient Jᵀr − kε as the last column.
    mixed: Vec<f64>,
    pub free_normal: DMatrix<f64>,
    pub free_gradient: DVector<f64>,
}

/// What enters the linearisation of one frame.
pub(crate) struct Local<'a> {
    /// ∂F/∂r; only the rows of cells with a target matter.
    pub jacobian: &'a BlockMatrix,
    /// Cells with a target: index, residual, and the free columns (2, p).
    pub rows: &'a [(usize, Vector<f64>, DMatrix<f64>)],
    pub nudges: &'a [Vector<f64>],
    pub spring: f64,
    pub free: usize,
}

/// One frame's part of a step before the coefficients' part is known.
pub(crate) struct Eliminated {
    order: usize,
    /// (JᵀJ + (k+λ)I)⁻¹ applied to the columns of `mixed`.
    solved: Vec<f64>,
    pub schur: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

impl Eliminated {
    /// δε for given δβ.
    pub fn nudge_step(&self, free_step: &DVector<f64>) -> Vec<f64> {
        let n = self.order;
        let mut step = self.solved[free_step.len() * n..].to_vec();
        for (column, delta) in self.solved.chunks_exact(n).zip(free_step.iter()) {
            for (s, c) in step.iter_mut().zip(column) {
                *s -= delta * c;
            }
        }
        step
    }
}

impl Linearisation {
    pub fn new(local: &Local<'_>) -> Result<Self, Error> {
        let normal = normal_matrix(local)?;
        let pattern = CholeskyPattern::new(&normal)?;
        let n = normal.order();
        let p = local.free;
        let mut mixed = vec![0.0; n * (p + 1)];
        let (mut free_normal, mut free_gradient) = (DMatrix::zeros(p, p), DVector::zeros(p));
        for (cell, residual, x) in local.rows {
            free_normal += x.transpose() * x;
            free_gradient += x.transpose() * DVector::from_column_slice(residual.as_slice());
            for (column, b) in local.jacobian.row(*cell) {
                let mut add = |right: usize, v: Vector<f64>| {
                    mixed[right * n + 2 * column] += b[0] * v.x + b[2] * v.y;
                    mixed[right * n + 2 * column + 1] += b[1] * v.x + b[3] * v.y;
                };
                for k in 0..p {
                    add(k, Vector::new(x[(0, k)], x[(1, k)]));
                }
                add(p, *residual);
            }
        }
        for (cell, nudge) in local.nudges.iter().enumerate() {
            mixed[p * n + 2 * cell] -= local.spring * nudge.x;
            mixed[p * n + 2 * cell + 1] -= local.spring * nudge.y;
        }
        Ok(Self { normal, pattern, mixed, free_normal, free_gradient })
    }

    /// Mean diagonal entry, the unit of damping.
    pub fn mean_diagonal(&self) -> f64 {
        self.normal.diagonal().sum::<f64>() / self.normal.order() as f64
    }

    /// Jᵀr − kε.
    pub fn nudge_gradient(&self) -> &[f64] {
        &self.mixed[self.free_gradient.len() * self.normal.order()..]
    }

    /// The factor of JᵀJ + (k+λ)I.
    pub fn factor(&self, damping: f64) -> Result<Cholesky, Error> {
        let mut damped = self.normal.clone();
        damped.shift_diagonal(damping);
        Ok(self.pattern.factor(&damped)?)
    }

    /// Eliminates the nudges: the Schur complement `XᵀX − XᵀJ (JᵀJ + (k+λ)I)⁻¹ JᵀX` and its right-hand side.
    pub fn eliminate(&self, damping: f64) -> Result<Eliminated, Error> {
        let factor = self.factor(damping)?;
        let (n, p) = (self.normal.order(), self.free_gradient.len());
        let mut solved = self.mixed.clone();
        factor.solve(&mut solved);
        let dot = |a: usize, b: usize| -> f64 {
            let columns = self.mixed[a * n..(a + 1) * n].iter().zip(&solved[b * n..(b + 1) * n]);
            columns.map(|(x, y)| x * y).sum()
        };
        let schur = DMatrix::from_fn(p, p, |a, b| self.free_normal[(a, b)] - dot(a, b));
        let gradient = DVector::from_fn(p, |a, _| self.free_gradient[a] - dot(a, p));
        Ok(Eliminated { order: n, solved, schur, gradient })
    }
}

/// `JᵀJ + kI`, lower triangle.
fn normal_matrix(local: &Local<'_>) -> Result<SymmetricMatrix, Error> {
    let jacobian = local.jacobian;
    let cells = local.nudges.len();
    let transposed = Transposed::new(jacobian, local.rows.iter().map(|row| row.0), cells);
    type Part = (Vec<usize>, Vec<usize>, Vec<f64>);
    let parts: Vec<Part> = (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut lengths, mut rows, mut values) = (Vec::new(), Vec::new(), Vec::new());
            let mut place = vec![usize::MAX; cells];
            let mut entries: Vec<(usize, [f64; 4])> = Vec::new();
            for column in chunk * CHUNK..((chunk + 1) * CHUNK).min(cells) {
                entries.push((column, [local.spring, 0.0, 0.0, local.spring]));
                place[column] = 0;
                for &(row, at) in transposed.column(column) {
                    let own = &jacobian.block[at];
                    for (other, b) in jacobian.row(row).filter(|(other, _)| *other >= column) {
                        // bᵀ · own
                        let product = [
                            b[0] * own[0] + b[2] * own[2],
                            b[0] * own[1] + b[2] * own[3],
                            b[1] * own[0] + b[3] * own[2],
                            b[1] * own[1] + b[3] * own[3],
                        ];
                        if place[other] == usize::MAX {
                            place[other] = entries.len();
                            entries.push((other, product));
                        } else {
                            let sum = &mut entries[place[other]].1;
                            sum.iter_mut().zip(product).for_each(|(s, x)| *s += x);
                        }
                    }
                }
                entries.iter().for_each(|(other, _)| place[*other] = usize::MAX);
                entries.sort_unstable_by_key(|entry| entry.0);
                for axis in 0..2 {
                    let first = rows.len();
                    for (other, block) in &entries {
                        for component in 0..2 {
                            if 2 * other + component >= 2 * column + axis {
                                rows.push(2 * other + component);
                                values.push(block[2 * component + axis]);
                            }
                        }
                    }
                    lengths.push(rows.len() - first);
                }
                entries.clear();
            }
            (lengths, rows, values)
        })
        .collect();
    let mut column_start = Vec::with_capacity(2 * cells + 1);
    column_start.push(0);
    let (mut rows, mut values, mut end) = (Vec::new(), Vec::new(), 0);
    for (part_lengths, part_rows, part_values) in parts {
        column_start.extend(part_lengths.iter().map(|length| {
            end += length;
            end
        }));
        rows.extend(part_rows);
        values.extend(part_values);
    }
    Ok(SymmetricMatrix::new(column_start, rows, values)?)
}

/// Where each block column has entries: row and index of the block.
struct Transposed {
    start: Vec<usize>,
    entry: Vec<(usize, usize)>,
}

impl Transposed {
    fn new(matrix: &BlockMatrix, rows: impl Iterator<Item = usize> + Clone, columns: usize) -> Self {
        let mut start = vec![0; columns + 1];
        for row in rows.clone() {
            for (column, _) in matrix.row(row) {
                start[column + 1] += 1;
            }
        }
        for column in 0..columns {
            start[column + 1] += start[column];
        }
        let (mut next, mut entry) = (start.clone(), vec![(0, 0); start[columns]]);
        for row in rows {
            for (at, (column, _)) in (matrix.row_start[row]..).zip(matrix.row(row)) {
                entry[next[column]] = (row, at);
                next[column] += 1;
            }
        }
        Self { start, entry }
    }

    fn column(&self, column: usize) -> &[(usize, usize)] {
        &self.entry[self.start[column]..self.start[column + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voronudge_geometry::{Domain, PeriodicBox, Tessellation};
    use voronudge_model::{Model, Parameters, jacobian};

    /// The eliminated step solves the full dense system.
    #[test]
    fn the_step_agrees_with_the_dense_normal_equations() {
        let positions: Vec<Vector<f64>> = (0..25)
            .map(|i| {
                let x = f64::from(i);
                Vector::new(f64::from(i % 5) + 0.3 * x.sin(), f64::from(i / 5) + 0.3 * (2.0 * x).cos())
            })
            .collect();
        let domain = Domain::Periodic(PeriodicBox::new([5.0, 5.0]).unwrap());
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let model = Model::chiral_voronoi(&Parameters { chirality: 0.7, ..Parameters::default() });
        let jacobian = jacobian(&tessellation, &positions, &model);
        let (cells, free, spring, damping) = (25, 2, 0.3, 0.05);
        // Some velocities are missing.
        let rows: Vec<(usize, Vector<f64>, DMatrix<f64>)> = (0..cells)
            .filter(|cell| cell % 4 != 0)
            .map(|cell| {
                let x = cell as f64;
                (
                    cell,
                    Vector::new(x.sin(), x.cos()),
                    DMatrix::from_fn(2, free, |i, j| (x + i as f64 + 3.0 * j as f64).cos()),
                )
            })
            .collect();
        let nudges: Vec<Vector<f64>> = (0..cells).map(|i| Vector::new(0.01 * i as f64, -0.02)).collect();
        let linearised =
            Linearisation::new(&Local { jacobian: &jacobian, rows: &rows, nudges: &nudges, spring, free })
                .unwrap();
        let dense = DMatrix::from_row_slice(2 * cells, 2 * cells, &jacobian.to_dense());
        let n = 2 * cells;
        let (mut full, mut right) =
            (DMatrix::<f64>::zeros(n + free, n + free), DVector::<f64>::zeros(n + free));
        for (cell, residual, x) in &rows {
            let mut wide = DMatrix::zeros(2, n + free);
            wide.view_mut((0, 0), (2, n)).copy_from(&dense.rows(2 * cell, 2));
            wide.view_mut((0, n), (2, free)).copy_from(x);
            full += wide.transpose() * &wide;
            right += wide.transpose() * residual;
        }
        for i in 0..n {
            full[(i, i)] += spring + damping;
            right[i] -= spring * nudges[i / 2][i % 2];
        }
        let expected = full.lu().solve(&right).unwrap();
        let eliminated = linearised.eliminate(damping).unwrap();
        let free_step = eliminated.schur.clone().lu().solve(&eliminated.gradient).unwrap();
        let step = eliminated.nudge_step(&free_step);
        let scale = expected.amax();
        assert!((0..free).all(|i| (free_step[i] - expected[n + i]).abs() < 1e-10 * scale));
        assert!((0..n).all(|i| (step[i] - expected[i]).abs() < 1e-10 * scale));
        // tr J (JᵀJ + kI)⁻¹ Jᵀ, dense.
        let mut seen = DMatrix::zeros(2 * rows.len(), n);
        for (k, (cell, ..)) in rows.iter().enumerate() {
            seen.view_mut((2 * k, 0), (2, n)).copy_from(&dense.rows(2 * cell, 2));
        }
        let hat = &seen
            * (seen.transpose() * &seen + DMatrix::identity(n, n) * spring).try_inverse().unwrap()
            * seen.transpose();
        let df = crate::degrees_of_freedom::degrees_of_freedom(&linearised, spring).unwrap();
        assert!((df - hat.trace()).abs() < 1e-8, "{df} {}", hat.trace());
    }
}
