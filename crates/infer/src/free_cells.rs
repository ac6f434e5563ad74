//! Cells that are not held, and their part of what there is of all cells.

use crate::rows::{Row, Rows};
use voronudge_model::BlockMatrix;

/// The cells of a frame that are not held, where most are.
#[derive(Debug)]
pub(crate) struct Free {
    pub cells: Vec<usize>,
    /// For each cell its place among these; of those that are held none.
    seat: Vec<u32>,
}

impl Free {
    /// Those of so many cells of which it is true.
    pub fn new(count: usize, is_free: impl Fn(usize) -> bool) -> Self {
        let cells: Vec<usize> = (0..count).filter(|cell| is_free(*cell)).collect();
        let mut seat = vec![u32::MAX; count];
        cells.iter().zip(0..).for_each(|(cell, place)| seat[*cell] = place);
        Self { cells, seat }
    }

    /// Number of cells, those that are held included.
    pub fn count(&self) -> usize {
        self.seat.len()
    }

    /// The place of a cell among those that are free.
    pub fn column_index(&self, cell: usize) -> Option<usize> {
        self.seat.get(cell).filter(|seat| **seat != u32::MAX).map(|seat| *seat as usize)
    }

    /// Their part of a vector with two numbers for each cell.
    pub fn of(&self, all: &[f64]) -> Vec<f64> {
        self.cells.iter().flat_map(|cell| [all[2 * cell], all[2 * cell + 1]]).collect()
    }

    /// A vector with two numbers for each cell, their part replaced.
    pub fn within(&self, all: &[f64], part: &[f64]) -> Vec<f64> {
        let mut all = all.to_vec();
        for (cell, own) in self.cells.iter().zip(part.chunks_exact(2)) {
            all[2 * cell..2 * cell + 2].copy_from_slice(own);
        }
        all
    }

    /// The rows that depend on free cells, with the columns of these alone.
    pub fn part_of(&self, rows: &Rows<'_>) -> (BlockMatrix, Vec<Row>) {
        let jacobian = self.columns_of(rows.jacobian);
        let meets = |row: &&Row| jacobian.row(row.0).next().is_some();
        let rows = rows.rows.iter().filter(meets).cloned().collect();
        (jacobian, rows)
    }

    /// The columns that a matrix has of free cells.
    pub fn columns_of(&self, matrix: &BlockMatrix) -> BlockMatrix {
        let mut columns = matrix.only(|cell| self.column_index(cell).is_some());
        self.renumber(&mut columns);
        columns
    }

    /// Makes the columns of a matrix those of free cells.
    pub fn renumber(&self, matrix: &mut BlockMatrix) {
        matrix.column.iter_mut().for_each(|column| *column = self.seat[*column as usize]);
    }
}
