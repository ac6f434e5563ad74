//! Sparse matrices of 2 × 2 blocks.

use voronudge_geometry::Vector;

/// A block `[xx, xy, yx, yy]`, row = component of the force.
pub(crate) type Block = [f64; 4];

/// A sparse matrix of 2 × 2 blocks in compressed rows: one block row and column for each cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BlockMatrix {
    /// First block of each row, and the number of blocks at the end.
    pub row_start: Vec<usize>,
    /// Block column; each appears once in a row, in no particular order.
    pub column: Vec<u32>,
    /// Entries `[xx, xy, yx, yy]`: the first letter is the component of the velocity.
    pub block: Vec<Block>,
}

impl BlockMatrix {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.row_start.len().saturating_sub(1)
    }

    /// The blocks of one row: column and entries.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &Block)> {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.column[range.clone()].iter().map(|&c| c as usize).zip(&self.block[range])
    }

    /// The matrix applied to a field of vectors.
    pub fn apply(&self, x: &[Vector<f64>]) -> Vec<Vector<f64>> {
        (0..self.rows())
            .map(|row| {
                self.row(row).fold(Vector::zeros(), |sum: Vector<f64>, (column, b)| {
                    let x = x[column];
                    sum + Vector::new(b[0] * x.x + b[1] * x.y, b[2] * x.x + b[3] * x.y)
                })
            })
            .collect()
    }

    /// The transpose of the matrix applied to a field of vectors: what a change of each position does to `Σ_i w_i·v_i`.
    pub fn apply_transposed(&self, w: &[Vector<f64>]) -> Vec<Vector<f64>> {
        let mut sums = vec![Vector::zeros(); self.rows()];
        for (row, w) in w.iter().enumerate() {
            for (column, b) in self.row(row) {
                sums[column] += Vector::new(b[0] * w.x + b[2] * w.y, b[1] * w.x + b[3] * w.y);
            }
        }
        sums
    }

    /// Multiplies one row by a factor.
    pub fn scale_row(&mut self, row: usize, factor: f64) {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.block[range].iter_mut().flatten().for_each(|entry| *entry *= factor);
    }

    /// The matrix with some of its block columns only.
    pub fn only(&self, kept: impl Fn(usize) -> bool) -> Self {
        let mut matrix = Self { row_start: vec![0], ..Self::default() };
        for row in 0..self.rows() {
            for (column, block) in self.row(row).filter(|(column, _)| kept(*column)) {
                matrix.column.push(column as u32);
                matrix.block.push(*block);
            }
            matrix.row_start.push(matrix.column.len());
        }
        matrix
    }

    /// The dense matrix, 2N × 2N row-major, in the order x₀, y₀, x₁, y₁, …
    pub fn to_dense(&self) -> Vec<f64> {
        let n = 2 * self.rows();
        let mut dense = vec![0.0; n * n];
        for row in 0..self.rows() {
            for (column, b) in self.row(row) {
                for (k, entry) in b.iter().enumerate() {
                    dense[(2 * row + k / 2) * n + 2 * column + k % 2] = *entry;
                }
            }
        }
        dense
    }
}
