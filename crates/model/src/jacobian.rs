//! The sparse Jacobian ∂v/∂r.

use crate::Model;
use crate::assembly::{CHUNK, split_by_cells};
use crate::element_jacobian::{Block, ElementJacobian};
use crate::response::respond_jacobian;
use crate::ring_jacobian::RingJacobian;
use rayon::prelude::*;
use voronudge_geometry::{Tessellation, Vector};

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
    /// First block of each cell's element, whose derivative is a matrix of blocks (force on a, by position of b).
    start: Vec<usize>,
    elements: Vec<Block>,
    /// The same for ring terms, with the cell itself and its position in the last row and column; empty without any.
    ring_start: Vec<usize>,
    ring_elements: Vec<Block>,
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
        self.evaluate_elements(tessellation, positions, model);
        self.evaluate_ring_elements(tessellation, positions, model);
        find_pattern(tessellation, matrix);
        let BlockMatrix { row_start, column, block } = matrix;
        let (row_start, column) = (&*row_start, &*column);
        block.resize(column.len(), [0.0; 4]);
        split_by_cells(block, tessellation.len(), |cell| row_start[cell]).into_par_iter().for_each_init(
            || Places::new(tessellation.len()),
            |places, (cells, block)| {
                let offset = row_start[cells.start];
                for cell in cells {
                    let range = row_start[cell]..row_start[cell + 1];
                    let row = &mut block[range.start - offset..range.end - offset];
                    row.fill([0.0; 4]);
                    places.enter(&column[range]);
                    if !row.is_empty() {
                        self.fill_row(tessellation, cell, places, row);
                    }
                }
            },
        );
        if !model.responses.is_empty() {
            *matrix = respond_jacobian(tessellation, positions, model, std::mem::take(matrix));
        }
    }

    fn evaluate_ring_elements(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
    ) {
        let Self { ring_start: start, ring_elements: elements, .. } = self;
        start.clear();
        elements.clear();
        if !model.has_ring_terms() {
            return;
        }
        start.push(0);
        let mut total = 0;
        start.extend((0..tessellation.len()).map(|cell| {
            total += (tessellation.ring(cell).len() + 1).pow(2);
            total
        }));
        let start = &*start;
        elements.resize(total, [0.0; 4]);
        split_by_cells(elements, tessellation.len(), |cell| start[cell]).into_par_iter().for_each_init(
            || RingJacobian::new(model),
            |jacobian, (cells, own)| {
                let offset = start[cells.start];
                for cell in cells.filter(|&cell| tessellation.is_closed(cell)) {
                    let blocks = &mut own[start[cell] - offset..start[cell + 1] - offset];
                    jacobian.fill(tessellation, positions, cell, blocks);
                }
            },
        );
    }

    fn evaluate_elements(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
    ) {
        let Self { start, elements, .. } = self;
        start.clear();
        start.push(0);
        let mut total = 0;
        start.extend((0..tessellation.len()).map(|cell| {
            total += tessellation.ring(cell).len().pow(2);
            total
        }));
        let start = &*start;
        elements.resize(total, [0.0; 4]);
        split_by_cells(elements, tessellation.len(), |cell| start[cell]).into_par_iter().for_each_init(
            || ElementJacobian::new(model),
            |jacobian, (cells, own)| {
                let offset = start[cells.start];
                for cell in cells.filter(|&cell| tessellation.is_closed(cell)) {
                    let ring = tessellation.ring(cell);
                    jacobian.fill(
                        cell,
                        ring.map(|h| tessellation.displacement(positions, cell, h)),
                        &mut own[start[cell] - offset..start[cell + 1] - offset],
                    );
                }
            },
        );
    }

    fn fill_row(&self, tessellation: &Tessellation, cell: usize, places: &Places, row: &mut [Block]) {
        // The cell's own element: the force on the cell is minus the sum over its ring.
        for slot in 0..tessellation.ring(cell).len() {
            self.add_slot(tessellation, cell, slot, -1.0, places, row);
        }
        for h in tessellation.ring(cell) {
            let owner = tessellation.neighbour(h);
            let slot = tessellation.twin(h) - tessellation.ring(owner).start;
            self.add_slot(tessellation, owner, slot, 1.0, places, row);
        }
        if !self.ring_start.is_empty() {
            self.add_ring_slot(tessellation, cell, tessellation.ring(cell).len(), places, row);
            for h in tessellation.ring(cell) {
                let owner = tessellation.neighbour(h);
                let slot = tessellation.twin(h) - tessellation.ring(owner).start;
                self.add_ring_slot(tessellation, owner, slot, places, row);
            }
        }
    }

    /// Adds the derivatives of the ring terms of `owner`: of the force on a slot of its ring, or on itself behind these.
    fn add_ring_slot(
        &self,
        tessellation: &Tessellation,
        owner: usize,
        slot: usize,
        places: &Places,
        row: &mut [Block],
    ) {
        let neighbours = tessellation.neighbours(owner);
        let points = neighbours.len() + 1;
        let blocks = &self.ring_elements[self.ring_start[owner] + slot * points..][..points];
        let own = places.of(owner as u32);
        for (k, block) in blocks.iter().enumerate() {
            // A displacement of the ring moves with its neighbour and against the cell.
            let at = neighbours.get(k).map_or(own, |&column| places.of(column));
            for (axis, derivative) in block.iter().enumerate() {
                row[at][axis] += derivative;
                if k + 1 < points {
                    row[own][axis] -= derivative;
                }
            }
        }
    }

    /// Adds the derivatives of the force of `owner` on slot `slot` of its ring.
    #[inline]
    fn add_slot(
        &self,
        tessellation: &Tessellation,
        owner: usize,
        slot: usize,
        sign: f64,
        places: &Places,
        row: &mut [Block],
    ) {
        let neighbours = tessellation.neighbours(owner);
        let begin = self.start[owner] + slot * neighbours.len();
        let mut sum = [0.0; 4];
        for (&column, block) in neighbours.iter().zip(&self.elements[begin..]) {
            let entries = &mut row[places.of(column)];
            for ((entry, total), derivative) in entries.iter_mut().zip(&mut sum).zip(block) {
                *entry += sign * derivative;
                *total += sign * derivative;
            }
        }
        for (entry, total) in row[places.of(owner as u32)].iter_mut().zip(sum) {
            *entry -= total;
        }
    }
}

/// Where each block column stands in the row at hand.
struct Places {
    place: Vec<u32>,
}

impl Places {
    fn new(cells: usize) -> Self {
        Self { place: vec![u32::MAX; cells] }
    }

    fn enter(&mut self, columns: &[u32]) {
        for (place, &column) in (0..).zip(columns) {
            self.place[column as usize] = place;
        }
    }

    #[inline]
    fn of(&self, column: u32) -> usize {
        self.place[column as usize] as usize
    }

    /// Whether a column has not been seen in this row yet; it is then marked with the row's number.
    fn is_new(&mut self, column: u32, row: u32) -> bool {
        std::mem::replace(&mut self.place[column as usize], row) != row
    }
}

/// A velocity depends on the cell, its neighbours, and their neighbours.
fn find_pattern(tessellation: &Tessellation, matrix: &mut BlockMatrix) {
    let cells = tessellation.len();
    let chunks: Vec<(Vec<usize>, Vec<u32>)> = (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map_init(
            || Places::new(cells),
            |seen, chunk| {
                let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(cells);
                let (mut lengths, mut columns) = (Vec::with_capacity(CHUNK), Vec::with_capacity(CHUNK * 20));
                for cell in range {
                    let first = columns.len();
                    if has_velocity(tessellation, cell) {
                        for &k in std::iter::once(&(cell as u32)).chain(tessellation.neighbours(cell)) {
                            for &j in std::iter::once(&k).chain(tessellation.neighbours(k as usize)) {
                                if seen.is_new(j, cell as u32) {
                                    columns.push(j);
                                }
                            }
                        }
                    }
                    lengths.push(columns.len() - first);
                }
                (lengths, columns)
            },
        )
        .collect();
    matrix.row_start.clear();
    matrix.column.clear();
    matrix.row_start.push(0);
    let mut end = 0;
    for (lengths, columns) in chunks {
        matrix.row_start.extend(lengths.iter().map(|length| {
            end += length;
            end
        }));
        matrix.column.extend_from_slice(&columns);
    }
}

pub(crate) fn has_velocity(tessellation: &Tessellation, cell: usize) -> bool {
    tessellation.is_closed(cell)
        && tessellation.neighbours(cell).iter().all(|&k| tessellation.is_closed(k as usize))
}
