//! The normal equations of one frame, linearised about the current nudges and coefficients.
//!
//! With r = v − F, J = ∂F/∂ε, X = ∂F/∂β, the data linearised back to the measured positions are y = r + Jε:
//!
//! ```text
//! v ≈ F + X δβ + J δε       y ≈ X δβ + J (ε + δε)
//! ```

use crate::Error;
use crate::gram::gram;
use crate::least_squares::invert;
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::Vector;
use voronudge_linalg::{Cholesky, CholeskyPattern, SymmetricMatrix};
use voronudge_model::BlockMatrix;

/// The linearised problem of one frame.
#[derive(Debug)]
pub(crate) struct Linearisation {
    /// JᵀJ
    normal: SymmetricMatrix,
    pattern: CholeskyPattern,
    /// The nudges ε at which it was linearised.
    nudges: Vec<f64>,
    /// JᵀX (2N × p, by columns), then Jᵀy as the last column.
    mixed: Vec<f64>,
    /// XᵀX.
    free_normal: DMatrix<f64>,
    /// Xᵀr.
    free_gradient: DVector<f64>,
    /// Jᵀr.
    gradient: Vec<f64>,
    /// Xᵀy.
    free_data: DVector<f64>,
    /// yᵀy.
    data: f64,
}

/// What enters the linearisation of one frame.
pub(crate) struct Local<'a> {
    /// ∂F/∂r; only the rows with a target matter.
    pub jacobian: &'a BlockMatrix,
    /// Data with a target: index, residual r, and the free columns (2, p).
    pub rows: &'a [(usize, Vector<f64>, DMatrix<f64>)],
    /// ε, x and y of one cell after the other.
    pub nudges: &'a [f64],
    pub free: usize,
}

/// `y = r + Jε` of one datum.
pub(crate) fn linearised_back(
    jacobian: &BlockMatrix,
    (datum, residual): (usize, Vector<f64>),
    nudges: &[f64],
) -> Vector<f64> {
    jacobian.row(datum).fold(residual, |y, (column, b)| {
        let (ex, ey) = (nudges[2 * column], nudges[2 * column + 1]);
        y + Vector::new(b[0] * ex + b[1] * ey, b[2] * ex + b[3] * ey)
    })
}

/// One frame's part of a step before the coefficients' part is known.
pub(crate) struct Eliminated {
    order: usize,
    /// (JᵀJ + (k+λ)I)⁻¹ applied to JᵀX and to Jᵀr − kε.
    solved: Vec<f64>,
    /// XᵀX − XᵀJ (JᵀJ + (k+λ)I)⁻¹ JᵀX
    pub schur: DMatrix<f64>,
    /// Its right-hand side.
    pub gradient: DVector<f64>,
    /// (Jᵀr − kε)ᵀ (JᵀJ + (k+λ)I)⁻¹ (Jᵀr − kε)
    pub gain: f64,
}

/// `W⁻¹ = (I + JJᵀ/k)⁻¹` between y and X, and its determinant.
#[derive(Debug, Clone)]
pub(crate) struct Whitened {
    /// XᵀW⁻¹X
    pub free: DMatrix<f64>,
    /// XᵀW⁻¹y
    pub mixed: DVector<f64>,
    /// yᵀW⁻¹y
    pub data: f64,
    /// log det W
    pub log_determinant: f64,
}

/// What generalised least squares leaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leftover {
    /// yᵀPy
    pub misfit: f64,
    /// log det W + log det XᵀW⁻¹X
    pub log_determinant: f64,
}

impl Whitened {
    /// The sum over frames, for p coefficients.
    pub fn sum<'a>(parts: impl IntoIterator<Item = &'a Self>, p: usize) -> Self {
        let nothing =
            Self { free: DMatrix::zeros(p, p), mixed: DVector::zeros(p), data: 0.0, log_determinant: 0.0 };
        parts.into_iter().fold(nothing, |mut sum, part| {
            sum.free += &part.free;
            sum.mixed += &part.mixed;
            sum.data += part.data;
            sum.log_determinant += part.log_determinant;
            sum
        })
    }

    /// What the best coefficients leave.
    ///
    /// # Errors
    /// [`Error::Degenerate`] if the data do not determine them.
    pub fn restricted(&self) -> Result<Leftover, Error> {
        let inverse = invert(self.free.clone())?;
        let factor = self.free.clone().cholesky().ok_or(Error::Degenerate)?;
        let information = 2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let misfit = self.data - (self.mixed.transpose() * inverse * &self.mixed).sum();
        Ok(Leftover { misfit, log_determinant: self.log_determinant + information })
    }
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
        let normal = gram(local.jacobian, local.rows.iter().map(|row| row.0), local.nudges.len() / 2)?;
        let pattern = CholeskyPattern::new(&normal)?;
        let n = normal.order();
        let p = local.free;
        let mut mixed = vec![0.0; n * (p + 1)];
        let mut gradient = vec![0.0; n];
        let (mut free_normal, mut free_gradient) = (DMatrix::zeros(p, p), DVector::zeros(p));
        let (mut free_data, mut data) = (DVector::zeros(p), 0.0);
        for (datum, residual, x) in local.rows {
            let y = linearised_back(local.jacobian, (*datum, *residual), local.nudges);
            data += y.norm_squared();
            free_normal += x.transpose() * x;
            free_gradient += x.transpose() * DVector::from_column_slice(residual.as_slice());
            free_data += x.transpose() * DVector::from_column_slice(y.as_slice());
            for (column, b) in local.jacobian.row(*datum) {
                let transposed = |v: Vector<f64>| [b[0] * v.x + b[2] * v.y, b[1] * v.x + b[3] * v.y];
                let add = |to: &mut [f64], v: Vector<f64>| {
                    to.iter_mut().zip(transposed(v)).for_each(|(sum, part)| *sum += part);
                };
                for k in 0..p {
                    let at = k * n + 2 * column;
                    add(&mut mixed[at..at + 2], Vector::new(x[(0, k)], x[(1, k)]));
                }
                let at = p * n + 2 * column;
                add(&mut mixed[at..at + 2], y);
                add(&mut gradient[2 * column..2 * column + 2], *residual);
            }
        }
        let nudges = local.nudges.to_vec();
        Ok(Self { normal, pattern, nudges, mixed, free_normal, free_gradient, gradient, free_data, data })
    }

    /// Number of nudge components.
    pub fn order(&self) -> usize {
        self.normal.order()
    }

    /// The trace of JᵀJ.
    pub fn trace(&self) -> f64 {
        self.normal.diagonal().sum()
    }

    /// XᵀX.
    pub fn free_normal(&self) -> &DMatrix<f64> {
        &self.free_normal
    }

    /// The factor of JᵀJ + kI.
    pub fn factor(&self, spring: f64) -> Result<Cholesky, Error> {
        let mut shifted = self.normal.clone();
        shifted.shift_diagonal(spring);
        Ok(self.pattern.factor(&shifted)?)
    }

    /// Eliminates the nudges from a damped Gauss–Newton step
    ///
    /// ```text
    /// [ JᵀJ + (k+λ)I   JᵀX ] [δε]   [ Jᵀr − kε ]
    /// [ XᵀJ            XᵀX ] [δβ] = [ Xᵀr      ]
    /// ```
    pub fn eliminate(&self, spring: f64, damping: f64) -> Result<Eliminated, Error> {
        let factor = self.factor(spring + damping)?;
        let (n, p) = (self.order(), self.free_gradient.len());
        let mut right = self.mixed[..n * p].to_vec();
        right.extend(self.gradient.iter().zip(&self.nudges).map(|(g, e)| g - spring * e));
        let mut solved = right.clone();
        factor.solve(&mut solved);
        let dot = |a: usize, b: usize| product(&right, &solved, n, a, b);
        let schur = DMatrix::from_fn(p, p, |a, b| self.free_normal[(a, b)] - dot(a, b));
        let gradient = DVector::from_fn(p, |a, _| self.free_gradient[a] - dot(a, p));
        Ok(Eliminated { order: n, gain: dot(p, p), schur, gradient, solved })
    }

    /// Generalised least squares about the measured positions, by `W⁻¹ = I − J (JᵀJ + kI)⁻¹ Jᵀ` and
    /// `det W = det(JᵀJ + kI) / kⁿ`.
    pub fn whiten(&self, spring: f64) -> Result<Whitened, Error> {
        let factor = self.factor(spring)?;
        let (n, p) = (self.order(), self.free_gradient.len());
        let mut solved = self.mixed.clone();
        factor.solve(&mut solved);
        let dot = |a: usize, b: usize| product(&self.mixed, &solved, n, a, b);
        Ok(Whitened {
            free: DMatrix::from_fn(p, p, |a, b| self.free_normal[(a, b)] - dot(a, b)),
            mixed: DVector::from_fn(p, |a, _| self.free_data[a] - dot(a, p)),
            data: self.data - dot(p, p),
            log_determinant: factor.log_determinant() - n as f64 * spring.ln(),
        })
    }

    /// Directions of the nudges that the data determine, `df = n − k tr (JᵀJ + kI)⁻¹`, which is n less the derivative of
    /// `log det(JᵀJ + kI)` with respect to log k.
    pub fn degrees_of_freedom(&self, spring: f64) -> Result<f64, Error> {
        let above = self.factor(spring * STEP.exp())?.log_determinant();
        let below = self.factor(spring * (-STEP).exp())?.log_determinant();
        let n = self.order() as f64;
        Ok((n - (above - below) / (2.0 * STEP)).clamp(0.0, n))
    }
}

/// Step in log k of the derivative of the log determinant; its square is the relative error.
const STEP: f64 = 2e-4;

/// The product of column a of one matrix and column b of another, both of n rows.
fn product(left: &[f64], right: &[f64], n: usize, a: usize, b: usize) -> f64 {
    left[a * n..(a + 1) * n].iter().zip(&right[b * n..(b + 1) * n]).map(|(x, y)| x * y).sum()
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
        let nudges: Vec<f64> = (0..cells).flat_map(|i| [0.01 * i as f64, -0.02]).collect();
        let local = Local { jacobian: &jacobian, rows: &rows, nudges: &nudges, free };
        let linearised = Linearisation::new(&local).unwrap();
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
            right[i] -= spring * nudges[i];
        }
        let expected = full.lu().solve(&right).unwrap();
        let eliminated = linearised.eliminate(spring, damping).unwrap();
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
        let df = linearised.degrees_of_freedom(spring).unwrap();
        assert!((df - hat.trace()).abs() < 1e-6, "{df} {}", hat.trace());
        // W = I + JJᵀ/k, dense.
        let m = 2 * rows.len();
        let w = DMatrix::identity(m, m) + &seen * seen.transpose() / spring;
        let inverse = w.clone().try_inverse().unwrap();
        let x = DMatrix::from_fn(m, free, |i, j| rows[i / 2].2[(i % 2, j)]);
        let residual = DVector::from_fn(m, |i, _| rows[i / 2].1[i % 2]);
        let y = residual + &seen * DVector::from_column_slice(&nudges);
        let whitened = linearised.whiten(spring).unwrap();
        assert!((whitened.free - x.transpose() * &inverse * &x).amax() < 1e-9);
        assert!((whitened.mixed - x.transpose() * &inverse * &y).amax() < 1e-9);
        assert!((whitened.data - (y.transpose() * &inverse * &y)[0]).abs() < 1e-9);
        let determinant = w.cholesky().unwrap().l().diagonal().iter().map(|d| 2.0 * d.ln()).sum::<f64>();
        assert!((whitened.log_determinant - determinant).abs() < 1e-9);
    }
}
