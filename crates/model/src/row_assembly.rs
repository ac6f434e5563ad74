//! Sparse matrices of blocks, row by row from sums of blocks.

use crate::BlockMatrix;
use crate::chunk::CHUNK;
use crate::element_jacobian::product;
use rayon::prelude::*;

/// One block row in the making.
#[derive(Debug)]
pub struct RowAssembly {
    /// Where each block column stands in the row.
    place: Vec<u32>,
    columns: Vec<u32>,
    blocks: Vec<[f64; 4]>,
}

impl RowAssembly {
    fn new(cells: usize) -> Self {
        Self { place: vec![u32::MAX; cells], columns: Vec::new(), blocks: Vec::new() }
    }

    /// Adds a block `[xx, xy, yx, yy]` in a column.
    #[inline]
    pub fn add(&mut self, column: usize, block: &[f64; 4]) {
        match self.blocks.get_mut(self.place[column] as usize) {
            Some(sum) => *sum = std::array::from_fn(|entry| sum[entry] + block[entry]),
            None => {
                self.place[column] = self.columns.len() as u32;
                self.columns.push(column as u32);
                self.blocks.push(*block);
            }
        }
    }

    /// Adds a block times a row of another matrix.
    pub fn add_row(&mut self, block: &[f64; 4], matrix: &BlockMatrix, row: usize) {
        for (column, entries) in matrix.row(row) {
            self.add(column, &product(block, entries));
        }
    }

    /// Adds a number times a row of another matrix.
    pub fn add_scaled_row(&mut self, factor: f64, matrix: &BlockMatrix, row: usize) {
        self.add_row(&[factor, 0.0, 0.0, factor], matrix, row);
    }

    fn clear(&mut self) {
        for &column in &self.columns {
            self.place[column as usize] = u32::MAX;
        }
        self.columns.clear();
        self.blocks.clear();
    }
}

/// A matrix of `rows` block rows, and as many columns, each row filled by a function of its number.
pub fn assemble(rows: usize, fill: impl Fn(usize, &mut RowAssembly) + Sync) -> BlockMatrix {
    let chunks: Vec<BlockMatrix> = (0..rows.div_ceil(CHUNK))
        .into_par_iter()
        .map_init(
            || RowAssembly::new(rows),
            |row, chunk| {
                let mut part = BlockMatrix::default();
                for number in chunk * CHUNK..((chunk + 1) * CHUNK).min(rows) {
                    fill(number, row);
                    part.column.extend_from_slice(&row.columns);
                    part.block.extend_from_slice(&row.blocks);
                    part.row_start.push(part.column.len());
                    row.clear();
                }
                part
            },
        )
        .collect();
    let mut matrix = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
    for part in chunks {
        let before = matrix.column.len();
        matrix.row_start.extend(part.row_start.iter().map(|end| before + end));
        matrix.column.extend(part.column);
        matrix.block.extend(part.block);
    }
    matrix
}
