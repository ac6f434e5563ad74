//! Square sparse matrices of real 2 × 2 blocks.

use crate::Error;
use rayon::prelude::*;
use std::ops::{AddAssign, Mul};

/// Rows of a product that are worth a task.
const ROWS: usize = 1024;

/// A square sparse matrix of real 2 × 2 blocks, in compressed rows. Row and column numbers count blocks.
///
/// ```
/// use voronudge_linalg::BlockSparse;
/// let matrix = BlockSparse::new(vec![0, 1], vec![0], vec![[0.0, -1.0, 1.0, 0.0]])?;
/// let mut turned = [0.0; 2];
/// matrix.apply(&[1.0, 0.0], &mut turned);
/// assert_eq!(turned, [0.0, 1.0]);
/// # Ok::<(), voronudge_linalg::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BlockSparse {
    pub(crate) row_start: Vec<usize>,
    pub(crate) column: Vec<u32>,
    pub(crate) block: Vec<[f64; 4]>,
}

/// The blocks of a matrix column by column: their rows, and where they stand in it.
#[derive(Debug)]
pub(crate) struct Columns {
    start: Vec<usize>,
    row: Vec<u32>,
    entry: Vec<u32>,
}

impl Columns {
    /// Rows of the blocks of a column.
    pub fn rows(&self, column: usize) -> &[u32] {
        &self.row[self.start[column]..self.start[column + 1]]
    }

    /// The blocks of a column of the matrix.
    pub fn of<'a>(
        &'a self,
        matrix: &'a BlockSparse,
        column: usize,
    ) -> impl Iterator<Item = (usize, &'a [f64; 4])> {
        let range = self.start[column]..self.start[column + 1];
        let blocks = self.entry[range.clone()].iter().map(|&entry| &matrix.block[entry as usize]);
        self.row[range].iter().map(|&row| row as usize).zip(blocks)
    }
}

impl BlockSparse {
    /// A matrix of `row_start.len() − 1` rows of blocks (xx, xy, yx, yy).
    ///
    /// # Errors
    /// [`Error::Malformed`] if the arrays do not fit together, [`Error::NotFinite`] for an entry that is infinite or not a
    /// number.
    pub fn new(row_start: Vec<usize>, column: Vec<u32>, block: Vec<[f64; 4]>) -> Result<Self, Error> {
        let rows = row_start.len().checked_sub(1).ok_or(Error::Malformed("no row starts"))?;
        let sound = column.len() == block.len()
            && row_start[0] == 0
            && row_start[rows] == column.len()
            && row_start.windows(2).all(|pair| pair[0] <= pair[1])
            && column.iter().all(|&column| (column as usize) < rows);
        if !sound {
            return Err(Error::Malformed("blocks, columns and row starts do not fit together"));
        }
        if let Some(at) = block.iter().position(|block| block.iter().any(|entry| !entry.is_finite())) {
            let row = row_start.partition_point(|&start| start <= at) - 1;
            return Err(Error::NotFinite { row: 2 * row });
        }
        Ok(Self { row_start, column, block })
    }

    /// Number of rows of blocks: half the order.
    pub fn rows(&self) -> usize {
        self.row_start.len() - 1
    }

    /// Number of rows of numbers.
    pub fn order(&self) -> usize {
        2 * self.rows()
    }

    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[f64; 4])> {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.column[range.clone()].iter().map(|&column| column as usize).zip(&self.block[range])
    }

    /// `y = A x`, both of the matrix' order and of real or complex numbers.
    pub fn apply<T>(&self, x: &[T], y: &mut [T])
    where
        T: Copy + Default + AddAssign + Mul<f64, Output = T> + Send + Sync,
    {
        let rows = y.par_chunks_exact_mut(2).enumerate().take(self.rows()).with_min_len(ROWS);
        rows.for_each(|(row, y)| {
            let (mut first, mut second) = (T::default(), T::default());
            for (column, b) in self.row(row) {
                let (p, q) = (x[2 * column], x[2 * column + 1]);
                first += p * b[0];
                first += q * b[1];
                second += p * b[2];
                second += q * b[3];
            }
            (y[0], y[1]) = (first, second);
        });
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let Columns { start, row, entry } = self.columns();
        let block = entry.iter().map(|&entry| self.block[entry as usize]);
        let block = block.map(|[xx, xy, yx, yy]| [xx, yx, xy, yy]).collect();
        Self { row_start: start, column: row, block }
    }

    /// Where the blocks of each column are.
    pub(crate) fn columns(&self) -> Columns {
        let mut start = vec![0; self.rows() + 1];
        for &column in &self.column {
            start[column as usize + 1] += 1;
        }
        for row in 0..self.rows() {
            start[row + 1] += start[row];
        }
        let mut next = start.clone();
        let (mut rows, mut entries) = (vec![0; self.column.len()], vec![0; self.column.len()]);
        for row in 0..self.rows() {
            for entry in self.row_start[row]..self.row_start[row + 1] {
                let next = &mut next[self.column[entry] as usize];
                (rows[*next], entries[*next]) = (row as u32, entry as u32);
                *next += 1;
            }
        }
        Columns { start, row: rows, entry: entries }
    }

    /// Largest sum of magnitudes in a row (the norm ‖A‖_∞): no eigenvalue is larger in magnitude.
    pub fn norm(&self) -> f64 {
        let sums = (0..self.rows()).flat_map(|row| {
            let sum = |k: usize| self.row(row).map(|(_, b)| b[k].abs() + b[k + 1].abs()).sum::<f64>();
            [sum(0), sum(2)]
        });
        sums.fold(0.0, f64::max)
    }

    /// The dense matrix, row by row.
    pub fn to_dense(&self) -> Vec<f64> {
        let n = self.order();
        let mut dense = vec![0.0; n * n];
        for row in 0..self.rows() {
            for (column, b) in self.row(row) {
                for (k, entry) in b.iter().enumerate() {
                    dense[(2 * row + k / 2) * n + 2 * column + k % 2] += entry;
                }
            }
        }
        dense
    }
}
