//! The sparse Jacobian of the terms, row by row from elements.

use crate::block_matrix::Block;
use crate::chunk::CHUNK;
use crate::element_blocks::ElementBlocks;
use crate::has_velocity::has_velocity;
use crate::{BlockMatrix, Model};
use rayon::prelude::*;
use std::ops::Range;
use voronudge_geometry::{Tessellation, Vector};

/// Builds Jacobians one after another in the same memory.
#[derive(Debug, Default)]
pub struct JacobianBuilder {
    /// Rows that are made at once, by one thread, from elements that stay in its cache. Elements of cells beside them are worked out again for
    /// each tile: cheaper than bringing those of all cells from memory, unless neighbours are far apart in number.
    tiles: Vec<Pattern>,
}

impl JacobianBuilder {
    /// The Jacobian of the terms alone, into an existing matrix.
    pub(crate) fn build_terms(
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
