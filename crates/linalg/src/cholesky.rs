//! Sparse Cholesky factorisation of symmetric positive definite matrices.

use crate::Error;
use crate::SelectedInverse;
use crate::SymmetricMatrix;
use crate::dissection::Dissection;
use crate::graph::Graph;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side};
use std::sync::{Arc, Mutex, PoisonError};

/// Solutions are few and quick.
const SEQUENTIAL: Par = Par::Seq;

/// Entries of a factor from which on it is worth while to share its dense blocks out to several tasks, and into how many.
const SHARED: usize = 10_000_000;
const TASKS: usize = 2;

/// Entries from which on several factors at once would take much memory.
const LARGE: usize = 40_000_000;

/// Memory of factors that are gone, for those to come: a page that is new to a process costs more than what is done with it.
static SPARE: Mutex<Vec<Vec<f64>>> = Mutex::new(Vec::new());

/// Pieces of it that are kept at most.
const SPARES: usize = 4;

/// Zeros, so many; `None` if there is no memory for them.
fn zeros(count: usize) -> Option<Vec<f64>> {
    let mut spares = SPARE.lock().unwrap_or_else(PoisonError::into_inner);
    let large_enough = |(_, spare): &(usize, &Vec<f64>)| spare.capacity() >= count;
    let least = spares.iter().enumerate().filter(large_enough).min_by_key(|(_, spare)| spare.capacity());
    let found = least.map(|(k, _)| k).map(|k| spares.swap_remove(k));
    drop(spares);
    let mut zeros = found.unwrap_or_default();
    zeros.clear();
    zeros.try_reserve_exact(count).ok()?;
    zeros.resize(count, 0.0);
    Some(zeros)
}

/// The fill-reducing order of a sparsity pattern: reusable for matrices that differ in their values only.
#[derive(Debug, Clone)]
pub struct CholeskyPattern {
    symbolic: Arc<SymbolicCholesky<usize>>,
}

impl CholeskyPattern {
    /// Analyses the pattern of a matrix; the order is that of approximate minimum degree.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        Self::with_threshold(matrix, SupernodalThreshold::AUTO, SymmetricOrdering::Amd)
    }

    /// Analyses the pattern of a matrix whose unknowns belong, in groups of one size that follow each other, to places in the plane or
    /// in space and time; those of a place that is `None` are coupled to all. The order is that of nested dissection by planes.
    ///
    /// # Errors
    /// [`Error::Malformed`] if unknowns cannot be shared out evenly, [`Error::OutOfMemory`].
    pub fn dissected(matrix: &SymmetricMatrix, places: &[Option<[f64; 3]>]) -> Result<Self, Error> {
        let order = matrix.order();
        if places.is_empty() || !order.is_multiple_of(places.len()) {
            return Err(Error::Malformed("places and unknowns do not fit together"));
        }
        let group = order / places.len();
        let (column_start, row) = matrix.places();
        let nodes = Dissection::order(&Graph::of_lower_triangle(column_start, row, group), places);
        let forward: Vec<usize> =
            nodes.iter().flat_map(|&node| (0..group).map(move |k| group * node as usize + k)).collect();
        let mut inverse = vec![0; order];
        forward.iter().enumerate().for_each(|(position, &unknown)| inverse[unknown] = position);
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, order));
        Self::with_threshold(matrix, SupernodalThreshold::AUTO, order)
    }

    /// Above the threshold of operations per entry, columns of the factor are taken together as dense blocks.
    pub(crate) fn with_threshold(
        matrix: &SymmetricMatrix,
        threshold: SupernodalThreshold,
        order: SymmetricOrdering<'_, usize>,
    ) -> Result<Self, Error> {
        let parameters =
            CholeskySymbolicParams { supernodal_flop_ratio_threshold: threshold, ..Default::default() };
        let symbolic = factorize_symbolic_cholesky(matrix.pattern(), Side::Lower, order, parameters)
            .map_err(|_| Error::OutOfMemory { order: matrix.order() })?;
        Ok(Self { symbolic: Arc::new(symbolic) })
    }

    /// Whether factors are so large that several at once would take much memory; the work on each is shared out then.
    pub fn is_large(&self) -> bool {
        self.symbolic.len_val() >= LARGE
    }

    /// How the work on a factor is shared out: the same for any number of threads, so that results are.
    fn tasks(&self) -> Par {
        if self.symbolic.len_val() >= SHARED { Par::rayon(TASKS) } else { Par::Seq }
    }

    /// Factorises a matrix of this pattern.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`].
    pub fn factor(&self, matrix: &SymmetricMatrix) -> Result<Cholesky, Error> {
        let out_of_memory = || Error::OutOfMemory { order: matrix.order() };
        let (symbolic, tasks) = (&self.symbolic, self.tasks());
        let mut values = zeros(symbolic.len_val()).ok_or_else(out_of_memory)?;
        let room = symbolic.factorize_numeric_llt_scratch::<f64>(tasks, Default::default());
        let mut scratch = MemBuffer::try_new(room).map_err(|_| out_of_memory())?;
        let outcome = symbolic.factorize_numeric_llt(
            &mut values,
            SparseColMatRef::new(matrix.pattern(), matrix.values()),
            Side::Lower,
            Default::default(),
            tasks,
            MemStack::new(&mut scratch),
            Default::default(),
        );
        match outcome {
            Ok(_) => Ok(Cholesky { symbolic: Arc::clone(symbolic), values }),
            Err(LltError::NonPositivePivot { .. }) => Err(Error::NotPositiveDefinite),
        }
    }
}

/// A factorised matrix `P A Pᵀ = L Lᵀ`, P a permutation.
#[derive(Debug, Clone)]
pub struct Cholesky {
    symbolic: Arc<SymbolicCholesky<usize>>,
    /// Entries of L, in the arrangement that the symbolic part states.
    values: Vec<f64>,
}

impl Drop for Cholesky {
    fn drop(&mut self) {
        let mut spares = SPARE.lock().unwrap_or_else(PoisonError::into_inner);
        spares.push(std::mem::take(&mut self.values));
        if spares.len() > SPARES {
            let least = (0..spares.len()).min_by_key(|k| spares[*k].capacity());
            least.map(|k| spares.swap_remove(k));
        }
    }
}

impl Cholesky {
    /// Factorises a matrix.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`].
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        CholeskyPattern::new(matrix)?.factor(matrix)
    }

    /// Replaces right-hand sides by solutions: one or several vectors of the matrix' order, one after the other.
    pub fn solve(&self, right_hand_sides: &mut [f64]) {
        let order = self.symbolic.nrows();
        let columns = right_hand_sides.len() / order.max(1);
        let room = self.symbolic.solve_in_place_scratch::<f64>(columns, SEQUENTIAL);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_hand_sides, order, columns),
            SEQUENTIAL,
            MemStack::new(&mut MemBuffer::new(room)),
        );
    }

    /// The inverse of the matrix where the factor has entries; `None` of a factor without dense blocks, that is, of small matrices.
    pub fn selected_inverse(&self) -> Option<SelectedInverse> {
        SelectedInverse::new(&self.symbolic, &self.values)
    }

    /// `log det A = 2 Σ log L_ii`: the determinant itself may be far outside the range of `f64`.
    ///
    /// ```
    /// use voronudge_linalg::{Cholesky, SymmetricMatrix};
    /// // [[4, 1], [1, 3]]
    /// let matrix = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![4.0, 1.0, 3.0])?;
    /// assert!((Cholesky::new(&matrix)?.log_determinant() - 11f64.ln()).abs() < 1e-15);
    /// # Ok::<(), voronudge_linalg::Error>(())
    /// ```
    pub fn log_determinant(&self) -> f64 {
        let half: f64 = match self.symbolic.raw() {
            // Every column of the factor starts at its diagonal entry.
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                symbolic.col_ptr()[..symbolic.ncols()].iter().map(|&start| self.values[start].ln()).sum()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLltRef::new(symbolic, &self.values);
                (0..symbolic.n_supernodes())
                    .map(|block| factor.supernode(block).val().diagonal().column_vector())
                    .flat_map(|diagonal| (0..diagonal.nrows()).map(move |i| diagonal[i].ln()))
                    .sum()
            }
        };
        2.0 * half
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let matrix = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 1.0]).unwrap();
        assert_eq!(Cholesky::new(&matrix).unwrap_err(), Error::NotPositiveDefinite);
    }

    const FORMS: [SupernodalThreshold; 3] = [
        SupernodalThreshold::AUTO,
        SupernodalThreshold::FORCE_SIMPLICIAL,
        SupernodalThreshold::FORCE_SUPERNODAL,
    ];

    /// A five-point Laplacian on a square grid that is held at zero around, plus a shift.
    fn laplacian(side: usize, shift: f64) -> SymmetricMatrix {
        let n = side * side;
        let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            row.push(i);
            value.push(4.0);
            for j in [(i % side + 1 < side).then_some(i + 1), (i + side < n).then_some(i + side)]
                .into_iter()
                .flatten()
            {
                row.push(j);
                value.push(-1.0);
            }
            start.push(row.len());
        }
        let mut matrix = SymmetricMatrix::new(start, row, value).unwrap();
        matrix.shift_diagonal(shift);
        matrix
    }

    fn times(matrix: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        for column in 0..x.len() {
            for k in matrix.places().0[column]..matrix.places().0[column + 1] {
                product[matrix.places().1[k]] += matrix.values()[k] * x[column];
                if matrix.places().1[k] != column {
                    product[column] += matrix.values()[k] * x[matrix.places().1[k]];
                }
            }
        }
        product
    }

    /// Two right-hand sides at once.
    #[test]
    fn solutions_satisfy_the_equations() {
        let matrix = laplacian(12, 0.3);
        let n = matrix.order();
        let given: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
        for form in FORMS {
            let mut x = given.clone();
            CholeskyPattern::with_threshold(&matrix, form, SymmetricOrdering::Amd)
                .unwrap()
                .factor(&matrix)
                .unwrap()
                .solve(&mut x);
            for (x, b) in x.chunks(n).zip(given.chunks(n)) {
                let worst = times(&matrix, x).iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-13, "{worst:e}");
            }
        }
    }

    /// The eigenvalues of the Laplacian are `4 − 2 cos(π j/(s+1)) − 2 cos(π k/(s+1))`, j and k from 1 to s.
    #[test]
    fn the_log_determinant_of_a_laplacian_is_the_sum_over_its_eigenvalues() {
        let (side, shift) = (60, 0.01);
        let matrix = laplacian(side, shift);
        let wave = |k: usize| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / (side as f64 + 1.0)).cos();
        let expected: f64 =
            (1..=side).flat_map(|j| (1..=side).map(move |k| (shift + wave(j) + wave(k)).ln())).sum();
        for form in FORMS {
            let pattern = CholeskyPattern::with_threshold(&matrix, form, SymmetricOrdering::Amd).unwrap();
            let simplicial = matches!(pattern.symbolic.raw(), SymbolicCholeskyRaw::Simplicial(_));
            assert!(form == SupernodalThreshold::AUTO || simplicial == (form == FORMS[1]));
            let found = pattern.factor(&matrix).unwrap().log_determinant();
            assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
        }
    }

    /// Another order is another way to the same numbers; a node that is coupled to all may have no place.
    #[test]
    fn a_dissected_matrix_has_the_same_factor_but_for_the_order() {
        let (side, shift) = (30, 0.1);
        let matrix = laplacian(side, shift);
        let places: Vec<Option<[f64; 3]>> = (0..side * side)
            .map(|i| (i != 17).then_some([(i % side) as f64, (i / side) as f64, 0.0]))
            .collect();
        let usual = Cholesky::new(&matrix).unwrap();
        let dissected = CholeskyPattern::dissected(&matrix, &places).unwrap().factor(&matrix).unwrap();
        assert!((usual.log_determinant() - dissected.log_determinant()).abs() < 1e-10);
        let given: Vec<f64> = (0..matrix.order()).map(|i| (i as f64).sin()).collect();
        let [mut x, mut y] = [given.clone(), given];
        usual.solve(&mut x);
        dissected.solve(&mut y);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-12));
        assert!(CholeskyPattern::dissected(&matrix, &places[..7]).is_err());
    }

    /// Bands with pseudo-random entries; one pattern serves matrices of other values.
    #[test]
    fn log_determinants_agree_with_dense_factors() {
        for (order, band) in [(1, 0), (2, 1), (7, 3), (40, 5), (40, 39)] {
            let columns = || (0..order).map(|column| column..(column + band + 1).min(order));
            let start = std::iter::once(0).chain(columns().scan(0, |end, rows| {
                *end += rows.len();
                Some(*end)
            }));
            let start: Vec<usize> = start.collect();
            let row: Vec<usize> = columns().flatten().collect();
            let value: Vec<f64> = (0..row.len()).map(|k| (7.0 * k as f64).sin()).collect();
            let mut matrix = SymmetricMatrix::new(start, row, value).unwrap();
            matrix.shift_diagonal(2.0 * band as f64 + 1.5);
            let patterns = FORMS
                .map(|form| CholeskyPattern::with_threshold(&matrix, form, SymmetricOrdering::Amd).unwrap());
            for _ in 0..2 {
                let mut dense = DMatrix::zeros(order, order);
                for column in 0..order {
                    for k in matrix.places().0[column]..matrix.places().0[column + 1] {
                        dense[(matrix.places().1[k], column)] = matrix.values()[k];
                    }
                }
                let lower = dense.cholesky().unwrap().unpack();
                let expected = 2.0 * lower.diagonal().map(f64::ln).sum();
                for pattern in &patterns {
                    let found = pattern.factor(&matrix).unwrap().log_determinant();
                    assert!((found - expected).abs() < 1e-13 * (1.0 + expected.abs()), "{found} {expected}");
                }
                matrix.shift_diagonal(0.7);
            }
        }
    }

    /// The determinant of the diagonal matrix, 1e-3000, is below the smallest `f64`.
    #[test]
    fn a_tiny_determinant_has_a_log_determinant() {
        let matrix =
            SymmetricMatrix::new((0..=1000).collect(), (0..1000).collect(), vec![1e-3; 1000]).unwrap();
        let found = Cholesky::new(&matrix).unwrap().log_determinant();
        assert!((found - 1000.0 * 1e-3f64.ln()).abs() < 1e-9);
    }
}
