//! A few eigenvalues of a large operator: Arnoldi's method, restarted with the best Ritz vectors (Krylov–Schur).

use crate::Error;
use crate::eigenpairs::{norm, orthonormal};
use crate::small_matrix::small_eigen;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use num_complex::Complex64;

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

/// The wanted eigenvalues, best first; those whose residual is above the tolerance did not converge in time.
pub(crate) fn arnoldi(
    order: usize,
    settings: &Settings,
    operator: &mut dyn FnMut(&[Complex64], &mut [Complex64]),
    restarted: &mut dyn FnMut(usize),
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
        let converged = ritz.iter().take(count).all(|(.., residual)| *residual <= settings.tolerance * scale);
        if converged || restart >= settings.restarts || dimension == order {
            return Ok(ritz
                .iter()
                .take(count)
                .map(|(value, weights, _)| Ritz { value: *value, vector: space.combine(weights) })
                .collect());
        }
        restarted(restart + 1);
        let kept = count + (dimension - count) / 2;
        space.shrink(ritz.iter().take(kept).map(|(_, weights, _)| weights.as_slice()));
    }
    Err(Error::NoConvergence { order })
}

/// `A V = V H + v bᵀ` with orthonormal columns V and the next vector v behind them.
struct Space {
    basis: Mat<Complex64>,
    /// H, with bᵀ as its last row.
    matrix: Mat<Complex64>,
    /// Columns that are in use.
    active: usize,
    seed: u64,
}

impl Space {
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
        let mut vector: Vec<Complex64> = (0..order)
            .map(|_| {
                self.seed = self.seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let mut bits = (self.seed ^ (self.seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                ((bits >> 11) as f64 / (1u64 << 53) as f64 - 0.5).into()
            })
            .collect();
        self.orthogonalise(column, &mut vector);
        let size = norm(&vector);
        for (row, entry) in vector.iter().enumerate() {
            self.basis[(row, column)] = if size > 0.0 { entry / size } else { Complex64::ZERO };
        }
    }

    /// Takes the first columns of the basis out of a vector, twice; their shares.
    fn orthogonalise(&self, columns: usize, vector: &mut [Complex64]) -> Vec<Complex64> {
        let mut total = vec![Complex64::ZERO; columns];
        for _ in 0..2 {
            for (k, total) in total.iter_mut().enumerate() {
                let column = self.column(k);
                let share: Complex64 = column.iter().zip(&*vector).map(|(v, x)| v.conj() * x).sum();
                vector.iter_mut().zip(column).for_each(|(x, v)| *x -= share * v);
                *total += share;
            }
        }
        total
    }

    fn column(&self, index: usize) -> &[Complex64] {
        let column: faer::ColRef<'_, Complex64> = self.basis.col(index);
        column.try_as_col_major().map_or(&[], |column| column.as_slice())
    }

    /// Applies the operator until the space is full.
    fn expand(&mut self, operator: &mut dyn FnMut(&[Complex64], &mut [Complex64])) {
        let dimension = self.matrix.ncols();
        let mut next = vec![Complex64::ZERO; self.basis.nrows()];
        for column in self.active..dimension {
            operator(self.column(column), &mut next);
            let size = norm(&next);
            let shares = self.orthogonalise(column + 1, &mut next);
            for (row, share) in shares.into_iter().enumerate() {
                self.matrix[(row, column)] = share;
            }
            let left = norm(&next);
            // Nothing new to rounding: the space is invariant, and goes on elsewhere.
            if left <= 1e-14 * size {
                self.random_column(column + 1);
            } else {
                self.matrix[(column + 1, column)] = left.into();
                for (row, entry) in next.iter().enumerate() {
                    self.basis[(row, column + 1)] = entry / left;
                }
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
                let residual: Complex64 = last.map(|(k, w)| self.matrix[(dimension, k)] * w).sum();
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
            vector.iter_mut().zip(self.column(k)).for_each(|(x, v)| *x += weight * v);
        }
        vector
    }

    /// Restarts with the space that some vectors span.
    fn shrink<'a>(&mut self, kept: impl Iterator<Item = &'a [Complex64]>) {
        let dimension = self.matrix.ncols();
        // Vectors that coalesce are entered once.
        let columns = orthonormal(kept.map(<[Complex64]>::to_vec), 1e-10);
        let count = columns.len();
        let q = Mat::from_fn(dimension, count, |row, column| columns[column][row]);
        let one = Complex64::ONE;
        let mut product = Mat::zeros(dimension + 1, count);
        matmul(product.as_mut(), Accum::Replace, self.matrix.as_ref(), q.as_ref(), one, Par::Seq);
        let mut inner = Mat::zeros(count, count);
        matmul(
            inner.as_mut(),
            Accum::Replace,
            q.adjoint(),
            product.as_ref().subrows(0, dimension),
            one,
            Par::Seq,
        );
        let mut basis = Mat::zeros(self.basis.nrows(), count);
        matmul(
            basis.as_mut(),
            Accum::Replace,
            self.basis.as_ref().subcols(0, dimension),
            q.as_ref(),
            one,
            Par::Seq,
        );
        let next = self.basis.col(dimension).to_owned();
        self.matrix.fill(Complex64::ZERO);
        self.matrix.as_mut().submatrix_mut(0, 0, count, count).copy_from(&inner);
        for column in 0..count {
            self.matrix[(count, column)] = product[(dimension, column)];
        }
        self.basis.as_mut().subcols_mut(0, count).copy_from(&basis);
        self.basis.as_mut().col_mut(count).copy_from(&next);
        self.active = count;
    }
}
