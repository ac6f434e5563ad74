//! Square sparse matrices of real 2 × 2 blocks.

use crate::Error;
use num_complex::Complex64;

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

    /// `y = A x`, both of the matrix' order.
    pub fn apply(&self, x: &[f64], y: &mut [f64]) {
        for (row, y) in y.chunks_exact_mut(2).enumerate().take(self.rows()) {
            let (mut first, mut second) = (0.0, 0.0);
            for (column, b) in self.row(row) {
                let (p, q) = (x[2 * column], x[2 * column + 1]);
                first += b[0] * p + b[1] * q;
                second += b[2] * p + b[3] * q;
            }
            (y[0], y[1]) = (first, second);
        }
    }

    /// `y = A x` for complex vectors.
    pub fn apply_complex(&self, x: &[Complex64], y: &mut [Complex64]) {
        for (row, y) in y.chunks_exact_mut(2).enumerate().take(self.rows()) {
            let (mut first, mut second) = (Complex64::ZERO, Complex64::ZERO);
            for (column, b) in self.row(row) {
                let (p, q) = (x[2 * column], x[2 * column + 1]);
                first += p * b[0] + q * b[1];
                second += p * b[2] + q * b[3];
            }
            (y[0], y[1]) = (first, second);
        }
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let mut row_start = vec![0; self.rows() + 1];
        for &column in &self.column {
            row_start[column as usize + 1] += 1;
        }
        for row in 0..self.rows() {
            row_start[row + 1] += row_start[row];
        }
        let mut next = row_start.clone();
        let mut column = vec![0; self.column.len()];
        let mut block = vec![[0.0; 4]; self.block.len()];
        for row in 0..self.rows() {
            for (target, b) in self.row(row) {
                column[next[target]] = row as u32;
                block[next[target]] = [b[0], b[2], b[1], b[3]];
                next[target] += 1;
            }
        }
        Self { row_start, column, block }
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
