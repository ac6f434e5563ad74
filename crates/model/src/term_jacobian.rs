//! The sparse Jacobian of the terms, row by row from elements.

use crate::block_matrix::Block;
use crate::element_blocks::ElementBlocks;
use crate::has_velocity::has_velocity;
use crate::tiles::tiles;
use crate::{BlockMatrix, Model};
use rayon::prelude::*;
use voronudge_geometry::{Tessellation, Vector};

/// Builds Jacobians one after another in the same memory.
#[derive(Debug, Default)]
pub struct JacobianBuilder {
    /// Rows that are made at once, by one thread, from elements that stay in its cache. Elements of cells beside them are worked out again for
    /// each tile: cheaper than bringing those of all cells from memory.
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
        self.find_pattern(tessellation, positions, &mut matrix.row_start);
        let BlockMatrix { row_start, column, block } = matrix;
        let blocks = row_start.last().copied().unwrap_or(0);
        column.resize(blocks, 0);
        block.resize(blocks, [0.0; 4]);
        let columns = rows_of_tiles(column, row_start, &self.tiles);
        let blocks = rows_of_tiles(block, row_start, &self.tiles);
        self.tiles.par_iter().zip(columns).zip(blocks).for_each_init(
            || ElementBlocks::new(tessellation, positions, model),
            |elements, ((tile, columns), blocks)| {
                elements.evaluate(&tile.cells);
                let (mut places, mut known) = (tile.places.as_slice(), tile.columns.as_slice());
                for ((&cell, columns), row) in tile.cells.iter().zip(columns).zip(blocks) {
                    let (own, rest) = known.split_at(columns.len());
                    columns.copy_from_slice(own);
                    known = rest;
                    row.fill([0.0; 4]);
                    if !row.is_empty() {
                        places = fill_row(elements, tessellation, cell as usize, places, row);
                    }
                }
            },
        );
    }

    fn find_pattern(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        row_start: &mut Vec<usize>,
    ) {
        let cells = tessellation.len();
        let tiles = tiles(tessellation, positions);
        self.tiles.resize_with(tiles.len(), Pattern::default);
        self.tiles.par_iter_mut().zip(tiles).for_each_init(
            || vec![(u32::MAX, 0); cells],
            |seen, (pattern, cells)| pattern.find(tessellation, cells, seen),
        );
        row_start.clear();
        row_start.resize(cells + 1, 0);
        for Pattern { cells, ends, .. } in &self.tiles {
            let mut before = 0;
            for (&cell, &end) in cells.iter().zip(ends) {
                row_start[cell as usize + 1] = end - before;
                before = end;
            }
        }
        for row in 0..cells {
            row_start[row + 1] += row_start[row];
        }
    }
}

/// What the rows of a matrix have in an array, tile by tile.
fn rows_of_tiles<'a, T>(array: &'a mut [T], row_start: &[usize], tiles: &[Pattern]) -> Vec<Vec<&'a mut [T]>> {
    let mut rest = array;
    let lengths = row_start.windows(2).map(|ends| ends[1] - ends[0]);
    let mut rows: Vec<&mut [T]> =
        lengths.map(|length| rest.split_off_mut(..length).unwrap_or_default()).collect();
    let mut row = |cell: &u32| std::mem::take(&mut rows[*cell as usize]);
    tiles.iter().map(|tile| tile.cells.iter().map(&mut row).collect()).collect()
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
    cells: Vec<u32>,
    /// Number of columns up to the end of each row.
    ends: Vec<usize>,
    columns: Vec<u32>,
    /// Where in a row the blocks of elements go: row by row, of the cell's own element and of those of its ring, the places of the
    /// cell and of its ring.
    places: Vec<u32>,
}

impl Pattern {
    /// `seen` has, of each column, the row in which it was seen last, and its place there.
    fn find(&mut self, tessellation: &Tessellation, cells: Vec<u32>, seen: &mut [(u32, u32)]) {
        let Self { ends, columns, places, .. } = self;
        ends.clear();
        columns.clear();
        places.clear();
        for &row in &cells {
            let first = columns.len();
            if has_velocity(tessellation, row as usize) {
                for &k in std::iter::once(&row).chain(tessellation.neighbours(row as usize)) {
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
