//! The sparse Jacobian ∂v/∂r.

use crate::Model;
use crate::assembly::CHUNK;
use crate::element_jacobian::ElementJacobian;
use rayon::prelude::*;
use voronudge_geometry::{Tessellation, Vector};

/// A sparse matrix of 2 × 2 blocks in compressed rows: one block row and column for each cell.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockMatrix {
    /// First block of each row, and the number of blocks at the end.
    pub row_start: Vec<usize>,
    /// Block column, ascending within a row.
    pub column: Vec<u32>,
    /// Entries `[xx, xy, yx, yy]`: the first letter is the component of the velocity.
    pub block: Vec<[f64; 4]>,
}

impl BlockMatrix {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.row_start.len() - 1
    }

    /// The blocks of one row: column and entries.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[f64; 4])> {
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

/// `J_{ij} = ∂v_i/∂r_j` at frozen topology, exact to rounding.
///
/// Each element is differentiated on its own (about twelve directions), in coordinates relative to its cell; the row and
/// column of the cell itself follow from the balance of forces and from translation. In an open field of view the rows
/// of cells without a velocity are empty.
pub fn jacobian(tessellation: &Tessellation, positions: &[Vector<f64>], model: &Model<f64>) -> BlockMatrix {
    let elements = Elements::evaluate(tessellation, positions, model);
    let cells = tessellation.len();
    let chunks: Vec<Rows> = (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| elements.rows(chunk * CHUNK..((chunk + 1) * CHUNK).min(cells)))
        .collect();
    let blocks = chunks.iter().map(|c| c.column.len()).sum();
    let mut matrix = BlockMatrix {
        row_start: Vec::with_capacity(cells + 1),
        column: Vec::with_capacity(blocks),
        block: Vec::with_capacity(blocks),
    };
    matrix.row_start.push(0);
    for rows in chunks {
        let offset = matrix.column.len();
        matrix.row_start.extend(rows.row_end.iter().map(|end| offset + end));
        matrix.column.extend(rows.column);
        matrix.block.extend(rows.block);
    }
    matrix
}

/// The derivatives of all elements.
struct Elements<'a> {
    tessellation: &'a Tessellation,
    /// First block of each cell.
    start: Vec<usize>,
    blocks: Vec<[f64; 4]>,
}

/// Some consecutive rows.
#[derive(Default)]
struct Rows {
    row_end: Vec<usize>,
    column: Vec<u32>,
    block: Vec<[f64; 4]>,
}

impl<'a> Elements<'a> {
    fn evaluate(tessellation: &'a Tessellation, positions: &[Vector<f64>], model: &Model<f64>) -> Self {
        let cells = tessellation.len();
        let mut start = Vec::with_capacity(cells + 1);
        start.push(0);
        let mut total = 0;
        for cell in 0..cells {
            total += tessellation.ring(cell).len().pow(2);
            start.push(total);
        }
        let mut blocks = vec![[0.0; 4]; total];
        let mut rest = blocks.as_mut_slice();
        let mut tasks = Vec::with_capacity(cells.div_ceil(CHUNK));
        for first in (0..cells).step_by(CHUNK) {
            let last = (first + CHUNK).min(cells);
            let (own, after) = rest.split_at_mut(start[last] - start[first]);
            rest = after;
            tasks.push((first..last, own));
        }
        tasks.into_par_iter().for_each(|(range, own)| {
            let mut jacobian = ElementJacobian::new(&model.terms);
            let offset = start[range.start];
            for cell in range.filter(|&cell| tessellation.is_closed(cell)) {
                let blocks = &mut own[start[cell] - offset..start[cell + 1] - offset];
                let ring = tessellation.ring(cell);
                jacobian.fill(ring.map(|h| tessellation.displacement(positions, cell, h)), blocks);
            }
        });
        Self { tessellation, start, blocks }
    }

    fn rows(&self, cells: std::ops::Range<usize>) -> Rows {
        let mut rows = Rows::default();
        rows.column.reserve(cells.len() * 19);
        rows.block.reserve(cells.len() * 19);
        let mut row = Row { place: vec![u32::MAX; self.tessellation.len()], ..Row::default() };
        for cell in cells {
            self.fill_row(cell, &mut row);
            row.drain_into(&mut rows);
        }
        rows
    }

    fn fill_row(&self, cell: usize, row: &mut Row) {
        let tessellation = self.tessellation;
        let complete = tessellation.is_closed(cell)
            && tessellation.neighbours(cell).iter().all(|&k| tessellation.is_closed(k as usize));
        if !complete {
            return;
        }
        // The cell's own element: the force on the cell is minus the sum over its ring.
        let sides = tessellation.ring(cell).len();
        for slot in 0..sides {
            self.add_slot(cell, slot, -1.0, row);
        }
        for h in tessellation.ring(cell) {
            let twin = tessellation.twin(h);
            let owner = tessellation.neighbour(h);
            self.add_slot(owner, twin - tessellation.ring(owner).start, 1.0, row);
        }
    }

    /// Adds the derivatives of the force of `owner` on slot `slot` of its ring.
    fn add_slot(&self, owner: usize, slot: usize, sign: f64, row: &mut Row) {
        let neighbours = self.tessellation.neighbours(owner);
        let sides = neighbours.len();
        let begin = self.start[owner] + slot * sides;
        let mut sum = [0.0; 4];
        for (&column, block) in neighbours.iter().zip(&self.blocks[begin..begin + sides]) {
            let signed = block.map(|entry| sign * entry);
            row.add(column, signed);
            for (total, entry) in sum.iter_mut().zip(signed) {
                *total += entry;
            }
        }
        row.add(owner as u32, sum.map(|entry| -entry));
    }
}

/// One row while it is summed.
#[derive(Default)]
struct Row {
    /// Where each column stands in `entries`.
    place: Vec<u32>,
    entries: Vec<(u32, [f64; 4])>,
}

impl Row {
    #[inline]
    fn add(&mut self, column: u32, block: [f64; 4]) {
        let place = &mut self.place[column as usize];
        if *place == u32::MAX {
            *place = self.entries.len() as u32;
            self.entries.push((column, block));
        } else {
            for (total, entry) in self.entries[*place as usize].1.iter_mut().zip(block) {
                *total += entry;
            }
        }
    }

    fn drain_into(&mut self, rows: &mut Rows) {
        self.entries.sort_unstable_by_key(|entry| entry.0);
        for (column, block) in self.entries.drain(..) {
            self.place[column as usize] = u32::MAX;
            rows.column.push(column);
            rows.block.push(block);
        }
        rows.row_end.push(rows.column.len());
    }
}
