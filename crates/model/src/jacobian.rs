//! The sparse Jacobian ∂v/∂r.

use crate::assembly::CHUNK;
use crate::block_matrix::Block;
use crate::element_blocks::ElementBlocks;
use crate::response::respond_jacobian;
use crate::{BlockMatrix, Model};
use rayon::prelude::*;
use std::ops::Range;
use voronudge_geometry::{Tessellation, Vector};

/// `J_{ij} = ∂v_i/∂r_j` at frozen topology, exact to rounding.
///
/// Each element is differentiated on its own, in coordinates relative to its cell; for shape terms the row and column of
/// the cell itself follow from the balance of forces and from translation. In an open field of view the rows of cells
/// without a velocity are empty. For one Jacobian after another see [`JacobianBuilder`].
///
/// Terms reach two rings. Responses reach further, and some of them leave something out, as their
/// [`exactness`](crate::FlowResponse::exactness) tells: of `time_lag` and `centroid_bias` the part with the second
/// derivative of the terms, of `internal_drag` the entries of the inverse below 1e-7 of the largest in a row. Everything
/// else is exact.
pub fn jacobian(tessellation: &Tessellation, positions: &[Vector<f64>], model: &Model<f64>) -> BlockMatrix {
    let mut matrix = BlockMatrix::default();
    JacobianBuilder::default().build(tessellation, positions, model, &mut matrix);
    matrix
}

/// Builds Jacobians one after another in the same memory.
#[derive(Debug, Default)]
pub struct JacobianBuilder {
    /// Rows that are made at once, by one thread, from elements that stay in its cache. Elements of cells beside them are worked out again for
    /// each tile: cheaper than bringing those of all cells from memory, unless neighbours are far apart in number.
    tiles: Vec<Pattern>,
}

impl JacobianBuilder {
    /// As [`jacobian`], into an existing matrix.
    pub fn build(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
        matrix: &mut BlockMatrix,
    ) {
        self.find_pattern(tessellation, matrix);
        let BlockMatrix { row_start, column, block } = matrix;
        block.resize(column.len(), [0.0; 4]);
        let (row_start, mut rest, mut rows) = (&*row_start, block.as_mut_slice(), Vec::new());
        for Pattern { cells, .. } in &self.tiles {
            let (own, after) = rest.split_at_mut(row_start[cells.end] - row_start[cells.start]);
            rest = after;
            rows.push(own);
        }
        self.tiles.par_iter().zip(rows).for_each_init(
            || ElementBlocks::new(tessellation, positions, model),
            |elements, (tile, block)| {
                elements.evaluate(tile.cells.clone());
                block.fill([0.0; 4]);
                let (offset, mut places) = (row_start[tile.cells.start], tile.places.as_slice());
                for cell in tile.cells.clone() {
                    let row = &mut block[row_start[cell] - offset..row_start[cell + 1] - offset];
                    if !row.is_empty() {
                        places = fill_row(elements, tessellation, cell, places, row);
                    }
                }
            },
        );
        if !model.responses.is_empty() {
            *matrix = respond_jacobian(tessellation, positions, model, std::mem::take(matrix));
        }
    }

    fn find_pattern(&mut self, tessellation: &Tessellation, matrix: &mut BlockMatrix) {
        let cells = tessellation.len();
        self.tiles.resize_with(cells.div_ceil(CHUNK), Pattern::default);
        self.tiles.par_iter_mut().enumerate().for_each_init(
            || vec![(u32::MAX, 0); cells],
            |seen, (tile, pattern)| {
                pattern.find(tessellation, tile * CHUNK..((tile + 1) * CHUNK).min(cells), seen)
            },
        );
        matrix.row_start.clear();
        matrix.column.clear();
        matrix.row_start.push(0);
        for Pattern { ends, columns, .. } in &self.tiles {
            let before = matrix.column.len();
            matrix.row_start.extend(ends.iter().map(|end| before + end));
            matrix.column.extend_from_slice(columns);
        }
    }
}

/// Adds what the elements of a cell and of its ring do to the cell, and returns the places of the next rows.
#[inline]
fn fill_row<'a>(
    elements: &ElementBlocks,
    tessellation: &Tessellation,
    cell: usize,
    mut places: &'a [u32],
    row: &mut [Block],
) -> &'a [u32] {
    let mut add = |owner: usize, of: usize| {
        let sides = tessellation.ring(owner).len();
        let (own, rest) = places.split_at(sides + 1);
        places = rest;
        for (&place, block) in own.iter().zip(elements.row(owner, sides, of)) {
            let total = &mut row[place as usize];
            *total = std::array::from_fn(|entry| total[entry] + block[entry]);
        }
    };
    add(cell, 0);
    for h in tessellation.ring(cell) {
        let owner = tessellation.neighbour(h);
        add(owner, 1 + tessellation.twin_place(h));
    }
    places
}

/// The columns of some rows. A velocity depends on the cell, its neighbours, and their neighbours.
#[derive(Debug, Default)]
struct Pattern {
    cells: Range<usize>,
    /// Number of columns up to the end of each row.
    ends: Vec<usize>,
    columns: Vec<u32>,
    /// Where in a row the blocks of elements go: row by row, of the cell's own element and of those of its ring, the places of the
    /// cell and of its ring.
    places: Vec<u32>,
}

impl Pattern {
    /// `seen` has, of each column, the row in which it was seen last, and its place there.
    fn find(&mut self, tessellation: &Tessellation, cells: Range<usize>, seen: &mut [(u32, u32)]) {
        let Self { ends, columns, places, .. } = self;
        ends.clear();
        columns.clear();
        places.clear();
        for cell in cells.clone() {
            let (row, first) = (cell as u32, columns.len());
            if has_velocity(tessellation, cell) {
                for &k in std::iter::once(&row).chain(tessellation.neighbours(cell)) {
                    for &j in std::iter::once(&k).chain(tessellation.neighbours(k as usize)) {
                        let (last, place) = &mut seen[j as usize];
                        if *last != row {
                            (*last, *place) = (row, (columns.len() - first) as u32);
                            columns.push(j);
                        }
                        places.push(*place);
                    }
                }
            }
            ends.push(columns.len());
        }
        self.cells = cells;
    }
}

pub(crate) fn has_velocity(tessellation: &Tessellation, cell: usize) -> bool {
    tessellation.is_closed(cell)
        && tessellation.neighbours(cell).iter().all(|&k| tessellation.is_closed(k as usize))
}
