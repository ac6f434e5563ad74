//! A few eigenvalues of a large operator: Arnoldi's method, restarted with the best Ritz vectors (Krylov–Schur).

use crate::Error;
use crate::eigenpairs::{norm, orthonormal};
use crate::number::Number;
use crate::small_matrix::small_eigen;
use faer::linalg::matmul::matmul;
use faer::{Accum, ColMut, ColRef, Mat, MatRef, Par};
use num_complex::Complex64;
use rayon::prelude::*;

/// Rows of the basis that are one task: results must not depend on the number of threads.
const ROWS: usize = 4096;

/// Which eigenvalues of the operator are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Preference {
    LargestMagnitude,
    LargestRealPart,
}

impl Preference {
    fn key(self, value: Complex64) -> f64 {
        match self {
            Self::LargestMagnitude => value.norm(),
            Self::LargestRealPart => value.re,
        }
    }
}

/// What is asked of the iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Settings {
    pub preference: Preference,
    pub count: usize,
    /// Residuals ‖A x − θ x‖ that are small enough, relative to the largest |θ|.
    pub tolerance: f64,
    pub restarts: usize,
}

/// An eigenvalue of the operator with its vector.
#[derive(Debug, Clone)]
pub(crate) struct Ritz {
    pub value: Complex64,
    pub vector: Vec<Complex64>,
}

/// The wanted eigenvalues, best first; those whose residual is above the tolerance did not converge in time. Tells how many per cent are
/// `done`. For a real operator all is real but for what is returned.
pub(crate) fn arnoldi<T: Number>(
    order: usize,
    settings: &Settings,
    operator: &mut dyn FnMut(&[T], &mut [T]),
    done: &mut dyn FnMut(usize),
) -> Result<Vec<Ritz>, Error> {
    let count = settings.count.min(order);
    if count == 0 {
        return Ok(Vec::new());
    }
    let dimension = (3 * count + 20).min(order);
    let mut space = Space::new(order, dimension);
    for restart in 0.. {
        space.expand(operator);
        let ritz = space.ritz(settings.preference)?;
        let scale = ritz.iter().map(|(value, ..)| value.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let residuals = ritz.iter().take(count).map(|(.., residual)| residual / scale);
        let worst = residuals.max_by(f64::total_cmp).unwrap_or(0.0);
        if worst <= settings.tolerance || restart >= settings.restarts || dimension == order {
            return Ok(ritz
                .iter()
                .take(count)
                .map(|(value, weights, _)| Ritz { value: *value, vector: space.combine(weights) })
                .collect());
        }
        // Residuals fall by about the same factor each time.
        let fallen =
            (worst.ln() / settings.tolerance.ln()).max((restart + 1) as f64 / settings.restarts as f64);
        done((100.0 * fallen.clamp(0.0, 0.99)) as usize);
        let kept = count + (dimension - count) / 2;
        space.shrink(ritz.iter().take(kept).flat_map(|(_, weights, _)| T::span(weights)));
    }
    Err(Error::NoConvergence { order })
}

/// `A V = V H + v bᵀ` with orthonormal columns V and the next vector v behind them.
struct Space<T: Number> {
    basis: Mat<T>,
    /// H, with bᵀ as its last row.
    matrix: Mat<T>,
    /// Columns that are in use.
    active: usize,
    seed: u64,
}

impl<T: Number> Space<T> {
    fn new(order: usize, dimension: usize) -> Self {
        let mut space = Self {
            basis: Mat::zeros(order, dimension + 1),
            matrix: Mat::zeros(dimension + 1, dimension),
            active: 0,
            seed: 0,
        };
        space.random_column(0);
        space
    }

    /// Puts a pseudo-random vector orthogonal to the columns before it.
    fn random_column(&mut self, column: usize) {
        let order = self.basis.nrows();
        let mut vector: Vec<T> = (0..order)
            .map(|_| {
                self.seed = self.seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let mut bits = (self.seed ^ (self.seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                real((bits >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
            })
            .collect();
        self.orthogonalise(column, &mut vector);
        let size = norm(&vector);
        self.enter(column, &vector, if size > 0.0 { 1.0 / size } else { 0.0 });
    }

    /// Takes the first columns of the basis out of a vector, twice; their shares.
    fn orthogonalise(&self, columns: usize, vector: &mut [T]) -> Mat<T> {
        let basis = self.basis.as_ref().subcols(0, columns);
        let rows = |task: usize, count: usize| basis.subrows(task * ROWS, count);
        let sum = |parts: Vec<Mat<T>>| parts.into_iter().fold(Mat::zeros(columns, 1), |sum, part| sum + part);
        let first = vector.par_chunks(ROWS).enumerate().map(|(task, x)| shares(rows(task, x.len()), x));
        let first = sum(first.collect());
        let second = vector.par_chunks_mut(ROWS).enumerate().map(|(task, x)| {
            take_out(rows(task, x.len()), &first, x);
            shares(rows(task, x.len()), x)
        });
        let second = sum(second.collect());
        let tasks = vector.par_chunks_mut(ROWS).enumerate();
        tasks.for_each(|(task, x)| take_out(rows(task, x.len()), &second, x));
        first + second
    }

    fn column(&self, index: usize) -> &[T] {
        let column: ColRef<'_, T> = self.basis.col(index);
        column.try_as_col_major().map_or(&[], |column| column.as_slice())
    }

    /// Puts a multiple of a vector into a column.
    fn enter(&mut self, column: usize, vector: &[T], factor: f64) {
        for (row, entry) in vector.iter().enumerate() {
            self.basis[(row, column)] = *entry * real::<T>(factor);
        }
    }

    /// Applies the operator until the space is full.
    fn expand(&mut self, operator: &mut dyn FnMut(&[T], &mut [T])) {
        let dimension = self.matrix.ncols();
        let mut next = vec![real(0.0); self.basis.nrows()];
        for column in self.active..dimension {
            operator(self.column(column), &mut next);
            let size = norm(&next);
            let shares = self.orthogonalise(column + 1, &mut next);
            self.matrix.as_mut().submatrix_mut(0, column, column + 1, 1).copy_from(&shares);
            let left = norm(&next);
            // Nothing new to rounding: the space is invariant, and goes on elsewhere.
            if left <= 1e-14 * size {
                self.random_column(column + 1);
            } else {
                self.matrix[(column + 1, column)] = real(left);
                self.enter(column + 1, &next, 1.0 / left);
            }
        }
        self.active = dimension;
    }

    /// Eigenvalues of H with their vectors and residuals, best first.
    fn ritz(&self, preference: Preference) -> Result<Vec<(Complex64, Vec<Complex64>, f64)>, Error> {
        let dimension = self.matrix.ncols();
        let (values, vectors) = small_eigen(self.matrix.as_ref().subrows(0, dimension))?;
        let mut all: Vec<_> = values
            .into_iter()
            .enumerate()
            .map(|(k, value)| {
                let weights: Vec<Complex64> = (0..dimension).map(|row| vectors[(row, k)]).collect();
                let size = norm(&weights);
                let weights: Vec<Complex64> = weights.into_iter().map(|w| w / size).collect();
                let last = weights.iter().enumerate();
                let residual: Complex64 =
                    last.map(|(k, w)| self.matrix[(dimension, k)].to_complex() * w).sum();
                (value, weights, residual.norm())
            })
            .collect();
        all.sort_by(|(a, ..), (b, ..)| {
            preference.key(*b).total_cmp(&preference.key(*a)).then(b.im.total_cmp(&a.im))
        });
        Ok(all)
    }

    fn combine(&self, weights: &[Complex64]) -> Vec<Complex64> {
        let mut vector = vec![Complex64::ZERO; self.basis.nrows()];
        for (k, weight) in weights.iter().enumerate() {
            vector.iter_mut().zip(self.column(k)).for_each(|(x, v)| *x += weight * v.to_complex());
        }
        vector
    }

    /// Restarts with the space that some vectors span.
    fn shrink(&mut self, kept: impl Iterator<Item = Vec<Complex64>>) {
        let dimension = self.matrix.ncols();
        // Vectors that coalesce are entered once.
        let columns = orthonormal(kept, 1e-10);
        let count = columns.len();
        let q = Mat::from_fn(dimension, count, |row, column| T::from_complex(columns[column][row]));
        let product = times(self.matrix.as_ref(), q.as_ref());
        let mut inner = Mat::zeros(count, count);
        let (rows, one) = (product.as_ref().subrows(0, dimension), real(1.0));
        matmul(inner.as_mut(), Accum::Replace, q.adjoint(), rows, one, Par::Seq);
        for first in (0..self.basis.nrows()).step_by(ROWS) {
            let rows = ROWS.min(self.basis.nrows() - first);
            let rows = self.basis.as_mut().subrows_mut(first, rows);
            let combined = times(rows.as_ref().subcols(0, dimension), q.as_ref());
            rows.subcols_mut(0, count).copy_from(&combined);
        }
        let next = self.basis.col(dimension).to_owned();
        self.matrix.fill(real(0.0));
        self.matrix.as_mut().submatrix_mut(0, 0, count, count).copy_from(&inner);
        self.matrix
            .as_mut()
            .submatrix_mut(count, 0, 1, count)
            .copy_from(product.as_ref().subrows(dimension, 1));
        self.basis.as_mut().col_mut(count).copy_from(&next);
        self.active = count;
    }
}

fn real<T: Number>(value: f64) -> T {
    T::from_complex(value.into())
}

fn times<T: Number>(a: MatRef<'_, T>, b: MatRef<'_, T>) -> Mat<T> {
    let mut product = Mat::zeros(a.nrows(), b.ncols());
    matmul(product.as_mut(), Accum::Replace, a, b, real(1.0), Par::Seq);
    product
}

/// `Vᴴ x`
fn shares<T: Number>(basis: MatRef<'_, T>, x: &[T]) -> Mat<T> {
    let mut shares = Mat::zeros(basis.ncols(), 1);
    let x = ColRef::from_slice(x).as_mat();
    matmul(shares.as_mut(), Accum::Replace, basis.adjoint(), x, real(1.0), Par::Seq);
    shares
}

/// `x − V s`
fn take_out<T: Number>(basis: MatRef<'_, T>, shares: &Mat<T>, x: &mut [T]) {
    let x = ColMut::from_slice_mut(x).as_mat_mut();
    matmul(x, Accum::Add, basis, shares.as_ref(), real(-1.0), Par::Seq);
}
