//! The Jacobian of a snapshot as an eigenvalue problem.

use crate::Error;
use crate::gradient::Gradients;
use voronudge_geometry::{Domain, Tessellation, Vector};
use voronudge_linalg::BlockSparse;
use voronudge_model::{BlockMatrix, Model, jacobian, jacobian_with_images};

/// `∂_t u = J u` for the cells that may move, the others held where they are.
#[derive(Debug, Clone)]
pub struct LinearProblem {
    pub(crate) matrix: BlockSparse,
    pub(crate) places: Vec<[f64; 2]>,
    pub(crate) gradients: Gradients,
    cells: Vec<usize>,
}

impl LinearProblem {
    /// The Jacobian of a model at positions (N). Only cells for which `moves` holds are displaced; in an open field that
    /// must not be more than those that have a velocity.
    ///
    /// # Errors
    /// [`Error::NoCells`] if no cell moves, [`Error::NotFinite`].
    pub fn new(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
        moves: impl Fn(usize) -> bool,
    ) -> Result<Self, Error> {
        let all = jacobian(tessellation, positions, model);
        Self::with_jacobian(tessellation, positions, &all, &[], moves)
    }

    /// The Jacobian of cells between walls, all of which move: the first `cells` of a tessellation whose others are their mirror images
    /// in `mirrors`, as [`jacobian_with_images`] has them.
    ///
    /// # Errors
    /// As [`LinearProblem::new`].
    pub fn with_images(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        model: &Model<f64>,
        mirrors: &[usize],
        cells: usize,
    ) -> Result<Self, Error> {
        let all = jacobian_with_images(tessellation, positions, model, mirrors, cells);
        Self::with_jacobian(tessellation, positions, &all, mirrors, |_| true)
    }

    fn with_jacobian(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        all: &BlockMatrix,
        mirrors: &[usize],
        moves: impl Fn(usize) -> bool,
    ) -> Result<Self, Error> {
        let cells: Vec<usize> = (0..all.rows()).filter(|&cell| moves(cell)).collect();
        if cells.is_empty() {
            return Err(Error::NoCells);
        }
        let mut number = vec![None; all.rows()];
        for (index, &cell) in cells.iter().enumerate() {
            number[cell] = Some(index as u32);
        }
        let mut row_start = vec![0];
        let (mut column, mut block) = (Vec::new(), Vec::new());
        for &cell in &cells {
            for (other, entries) in all.row(cell) {
                if let Some(other) = number[other] {
                    if entries.iter().any(|entry| !entry.is_finite()) {
                        return Err(Error::NotFinite { cell });
                    }
                    column.push(other);
                    block.push(*entries);
                }
            }
            row_start.push(column.len());
        }
        let wrapped = |r: Vector<f64>| match tessellation.domain() {
            Domain::Periodic(cell_box) => cell_box.wrap(r),
            Domain::Open => r,
        };
        Ok(Self {
            matrix: BlockSparse::new(row_start, column, block)?,
            places: cells.iter().map(|&cell| wrapped(positions[cell])).map(|r| [r.x, r.y]).collect(),
            gradients: Gradients::new(tessellation, positions, &cells, &number, mirrors),
            cells,
        })
    }

    /// The cells that move, ascending: entries 2k and 2k + 1 of a mode are the components of cell `cells()[k]`.
    pub fn cells(&self) -> &[usize] {
        &self.cells
    }

    /// Largest sum of magnitudes in a row of the Jacobian: no rate is larger.
    pub fn largest_rate(&self) -> f64 {
        self.matrix.norm()
    }
}
