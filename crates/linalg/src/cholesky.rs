//! Sparse Cholesky factorisation of symmetric positive definite matrices of which nothing is known but their pattern.

use crate::Error;
use crate::SymmetricMatrix;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
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

/// How the columns of a factor are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorForm {
    /// Each for itself.
    Simplicial,
    /// Those with entries in the same rows together, as dense blocks.
    Supernodal,
}

/// A factorised matrix `P A Pᵀ = L Lᵀ`, P a permutation.
#[derive(Debug)]
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    /// Entries of L, in the arrangement that the symbolic part states.
    values: Vec<f64>,
}

/// Memory in which solutions are found, to be used again.
pub struct Scratch(MemBuffer);

impl Default for Scratch {
    fn default() -> Self {
        Self(MemBuffer::new(StackReq::EMPTY))
    }
}

impl Cholesky {
    /// Factorises a matrix, in the order of approximate minimum degree.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`].
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        Self::with_threshold(matrix, SupernodalThreshold::AUTO)
    }

    /// The same by a factor of one form; [`Cholesky::new`] takes the one that should take less time.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`].
    pub fn in_form(matrix: &SymmetricMatrix, form: FactorForm) -> Result<Self, Error> {
        Self::with_threshold(
            matrix,
            match form {
                FactorForm::Simplicial => SupernodalThreshold::FORCE_SIMPLICIAL,
                FactorForm::Supernodal => SupernodalThreshold::FORCE_SUPERNODAL,
            },
        )
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

    /// In which form the factor is.
    pub fn form(&self) -> FactorForm {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => FactorForm::Simplicial,
            SymbolicCholeskyRaw::Supernodal(_) => FactorForm::Supernodal,
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

    /// The same with right-hand sides side by side: the numbers of all of them for the first unknown, then for the next.
    pub fn solve_side_by_side(&self, right_hand_sides: &mut [f64], scratch: &mut Scratch) {
        let order = self.symbolic.nrows();
        let columns = right_hand_sides.len() / order.max(1);
        let needed = self.symbolic.solve_in_place_scratch::<f64>(columns, SEQUENTIAL);
        if scratch.0.len() < needed.unaligned_bytes_required() {
            scratch.0 = MemBuffer::new(needed);
        }
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_row_major_slice_mut(right_hand_sides, order, columns),
            SEQUENTIAL,
            MemStack::new(&mut scratch.0),
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
