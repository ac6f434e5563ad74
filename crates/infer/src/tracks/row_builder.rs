//! Rows of blocks in the unknowns of a movie.

use super::instants::Place;
use voronudge_model::BlockMatrix;

/// Builds rows of blocks whose columns come in any order, some of them several times.
pub(super) struct RowBuilder {
    pub matrix: BlockMatrix,
    /// Where each column stands in the row at hand.
    at: Vec<u32>,
}

/// A column that the row at hand does not have.
const NONE: u32 = u32::MAX;

impl RowBuilder {
    pub fn new(columns: usize) -> Self {
        let matrix = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        Self { matrix, at: vec![NONE; columns] }
    }

    /// Adds a factor times a block in the columns of a place.
    pub fn add(&mut self, place: Place, factor: f64, block: &[f64; 4]) {
        for (column, share) in place.shares() {
            let at = &mut self.at[column];
            if *at == NONE {
                *at = self.matrix.column.len() as u32;
                self.matrix.column.push(column as u32);
                self.matrix.block.push([0.0; 4]);
            }
            let sum = &mut self.matrix.block[*at as usize];
            sum.iter_mut().zip(block).for_each(|(s, b)| *s += factor * share * b);
        }
    }

    pub fn end(&mut self) {
        let begin = self.matrix.row_start.last().copied().unwrap_or(0);
        for column in &self.matrix.column[begin..] {
            self.at[*column as usize] = NONE;
        }
        self.matrix.row_start.push(self.matrix.column.len());
    }
}
