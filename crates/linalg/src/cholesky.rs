//! Sparse Cholesky factorisation of symmetric positive definite matrices.

use crate::Error;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::LltError;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{MatMut, Side};

/// The lower triangle of a sparse symmetric matrix, in compressed columns.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetricMatrix {
    column_start: Vec<usize>,
    row: Vec<usize>,
    value: Vec<f64>,
}

impl SymmetricMatrix {
    /// A matrix of order `column_start.len() − 1`. Every column holds its diagonal entry first, then the entries below
    /// in ascending rows.
    ///
    /// # Errors
    /// [`Error::Malformed`] if the arrays do not fit together.
    pub fn new(column_start: Vec<usize>, row: Vec<usize>, value: Vec<f64>) -> Result<Self, Error> {
        let order = column_start.len().checked_sub(1).ok_or(Error::Malformed("no column starts"))?;
        if row.len() != value.len() || column_start[0] != 0 || column_start[order] != row.len() {
            return Err(Error::Malformed("array lengths differ"));
        }
        for (column, range) in column_start.windows(2).enumerate() {
            let rows = row.get(range[0]..range[1]).ok_or(Error::Malformed("column starts descend"))?;
            let sound = rows.first() == Some(&column)
                && rows.windows(2).all(|pair| pair[0] < pair[1])
                && rows.last().is_some_and(|&last| last < order);
            if !sound {
                return Err(Error::Malformed("a column does not start at its diagonal and ascend"));
            }
        }
        Ok(Self { column_start, row, value })
    }

    /// Number of rows.
    pub fn order(&self) -> usize {
        self.column_start.len() - 1
    }

    /// The diagonal.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> {
        self.column_start[..self.order()].iter().map(|&start| self.value[start])
    }

    /// Adds `shift` to every diagonal entry.
    pub fn shift_diagonal(&mut self, shift: f64) {
        for column in 0..self.order() {
            self.value[self.column_start[column]] += shift;
        }
    }

    fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.order(), self.order(), &self.column_start, None, &self.row)
    }
}

/// The fill-reducing order of a sparsity pattern: reusable for matrices that differ in their values only.
#[derive(Debug, Clone)]
pub struct CholeskyPattern {
    symbolic: SymbolicLlt<usize>,
}

impl CholeskyPattern {
    /// Analyses the pattern of a matrix.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        // Results must not depend on the number of threads.
        faer::set_global_parallelism(faer::Par::Seq);
        let symbolic = SymbolicLlt::try_new(matrix.pattern(), Side::Lower)
            .map_err(|_| Error::OutOfMemory { order: matrix.order() })?;
        Ok(Self { symbolic })
    }

    /// Factorises a matrix of this pattern.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`], [`Error::OutOfMemory`].
    pub fn factor(&self, matrix: &SymmetricMatrix) -> Result<Cholesky, Error> {
        let numbers = SparseColMatRef::new(matrix.pattern(), &matrix.value);
        match Llt::try_new_with_symbolic(self.symbolic.clone(), numbers, Side::Lower) {
            Ok(factor) => Ok(Cholesky { factor, order: matrix.order() }),
            Err(LltError::Numeric(_)) => Err(Error::NotPositiveDefinite),
            Err(LltError::Generic(_)) => Err(Error::OutOfMemory { order: matrix.order() }),
        }
    }
}

/// A factorised matrix.
#[derive(Debug, Clone)]
pub struct Cholesky {
    factor: Llt<usize, f64>,
    order: usize,
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
        let columns = right_hand_sides.len() / self.order.max(1);
        self.factor.solve_in_place(MatMut::from_column_major_slice_mut(
            right_hand_sides,
            self.order,
            columns,
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let matrix = SymmetricMatrix::new(vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 1.0]).unwrap();
        assert_eq!(Cholesky::new(&matrix).unwrap_err(), Error::NotPositiveDefinite);
    }

    #[test]
    fn malformed_arrays_are_refused() {
        assert!(SymmetricMatrix::new(vec![0, 2, 3], vec![1, 0, 1], vec![1.0; 3]).is_err());
        assert!(SymmetricMatrix::new(vec![0, 2], vec![0, 1], vec![1.0; 2]).is_err());
        assert!(SymmetricMatrix::new(vec![], vec![], vec![]).is_err());
    }

    /// A five-point Laplacian plus a shift, solved for two right-hand sides at once.
    #[test]
    fn solutions_satisfy_the_equations() {
        let (side, shift) = (12, 0.3);
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
        let given: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
        let mut x = given.clone();
        Cholesky::new(&matrix).unwrap().solve(&mut x);
        for (x, b) in x.chunks(n).zip(given.chunks(n)) {
            let mut product = vec![0.0; n];
            for column in 0..n {
                for k in matrix.column_start[column]..matrix.column_start[column + 1] {
                    product[matrix.row[k]] += matrix.value[k] * x[column];
                    if matrix.row[k] != column {
                        product[column] += matrix.value[k] * x[matrix.row[k]];
                    }
                }
            }
            let worst = product.iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-13, "{worst:e}");
        }
    }
}
