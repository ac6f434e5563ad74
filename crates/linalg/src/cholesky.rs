//! Sparse Cholesky factorisation of symmetric positive definite matrices of which nothing is known but their pattern.

use crate::Error;
use crate::SymmetricMatrix;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side};

/// For matrices that are small.
const SEQUENTIAL: Par = Par::Seq;

/// A factorised matrix `P A Pᵀ = L Lᵀ`, P a permutation.
#[derive(Debug)]
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    /// Entries of L, in the arrangement that the symbolic part states.
    values: Vec<f64>,
}

impl Cholesky {
    /// Factorises a matrix, in the order of approximate minimum degree.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`].
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        Self::with_threshold(matrix, SupernodalThreshold::AUTO)
    }

    /// Above the threshold of operations per entry, columns of the factor are taken together as dense blocks.
    fn with_threshold(matrix: &SymmetricMatrix, threshold: SupernodalThreshold) -> Result<Self, Error> {
        let out_of_memory = || Error::OutOfMemory { order: matrix.order() };
        let parameters =
            CholeskySymbolicParams { supernodal_flop_ratio_threshold: threshold, ..Default::default() };
        let order = SymmetricOrdering::Amd;
        let symbolic = factorize_symbolic_cholesky(matrix.pattern(), Side::Lower, order, parameters)
            .map_err(|_| out_of_memory())?;
        let mut values = Vec::new();
        values.try_reserve_exact(symbolic.len_val()).map_err(|_| out_of_memory())?;
        values.resize(symbolic.len_val(), 0.0);
        let room = symbolic.factorize_numeric_llt_scratch::<f64>(SEQUENTIAL, Default::default());
        let mut scratch = MemBuffer::try_new(room).map_err(|_| out_of_memory())?;
        let outcome = symbolic.factorize_numeric_llt(
            &mut values,
            SparseColMatRef::new(matrix.pattern(), matrix.values()),
            Side::Lower,
            Default::default(),
            SEQUENTIAL,
            MemStack::new(&mut scratch),
            Default::default(),
        );
        match outcome {
            Ok(_) => Ok(Self { symbolic, values }),
            Err(LltError::NonPositivePivot { .. }) => Err(Error::NotPositiveDefinite),
        }
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
            Cholesky::with_threshold(&matrix, form).unwrap().solve(&mut x);
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
            let factor = Cholesky::with_threshold(&matrix, form).unwrap();
            let simplicial = matches!(factor.symbolic.raw(), SymbolicCholeskyRaw::Simplicial(_));
            assert!(form == SupernodalThreshold::AUTO || simplicial == (form == FORMS[1]));
            let found = factor.log_determinant();
            assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
        }
    }

    /// Bands with pseudo-random entries.
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
            for _ in 0..2 {
                let mut dense = DMatrix::zeros(order, order);
                for column in 0..order {
                    for k in matrix.places().0[column]..matrix.places().0[column + 1] {
                        dense[(matrix.places().1[k], column)] = matrix.values()[k];
                    }
                }
                let lower = dense.cholesky().unwrap().unpack();
                let expected = 2.0 * lower.diagonal().map(f64::ln).sum();
                for form in FORMS {
                    let found = Cholesky::with_threshold(&matrix, form).unwrap().log_determinant();
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
