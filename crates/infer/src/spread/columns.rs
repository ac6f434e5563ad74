//! What the parameters of single cells do to what is measured.

use crate::objective::{Measurable, Objective};
use crate::rows::linearised_back;
use crate::{Error, Observation, Velocities};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::collections::HashMap;
use voronudge_geometry::Vector;
use voronudge_model::{BlockMatrix, CellParameter, cell_derivatives};

/// Most unknown parameters of cells: the linear algebra is dense.
const LARGEST: usize = 4000;

/// Which unknown belongs to which cell: those of one parameter follow each other, one for each cell of the tissue.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub parameters: Vec<CellParameter>,
    /// Number of cells of the tissue.
    pub cells: usize,
    /// Which of them the cells of each frame are.
    pub of_frames: Vec<Vec<usize>>,
}

impl Layout {
    /// Cells of one identity are the same in all frames; those without one are new in each.
    pub fn new(frames: &[Observation], parameters: &[CellParameter]) -> Result<Self, Error> {
        let mut known = HashMap::new();
        let mut cells = 0;
        let mut of_frames = Vec::with_capacity(frames.len());
        for frame in frames {
            if !matches!(frame.velocities, Velocities::OfCells(_)) {
                return Err(Error::Spread(
                    "cells that differ are told from velocities of cells, not from a flow field",
                ));
            }
            let mut next = || {
                cells += 1;
                cells - 1
            };
            let own = (0..frame.positions.len()).map(|cell| match frame.identity(cell) {
                Some(identity) => *known.entry(identity).or_insert_with(&mut next),
                None => next(),
            });
            of_frames.push(own.collect());
        }
        if cells * parameters.len() > LARGEST {
            return Err(Error::Spread("cells that differ are told of up to 4000 cells times parameters"));
        }
        Ok(Self { parameters: parameters.to_vec(), cells, of_frames })
    }

    /// Number of unknowns.
    pub fn order(&self) -> usize {
        self.parameters.len() * self.cells
    }

    /// The unknowns of one parameter.
    pub fn block(&self, parameter: usize) -> std::ops::Range<usize> {
        parameter * self.cells..(parameter + 1) * self.cells
    }
}

/// One frame's data with their derivatives by the unknowns of the cells.
pub(super) struct FrameColumns {
    /// Z (data × unknowns)
    pub of_cells: DMatrix<f64>,
    /// JᵀZ (nudges × unknowns)
    pub coupled: DMatrix<f64>,
    /// X (data × coefficients)
    pub free: DMatrix<f64>,
    /// y
    pub data: DVector<f64>,
}

/// The columns of all frames about a point; unknowns are relative to the parameters of the model.
pub(super) fn columns(
    objective: &Objective<'_>,
    parameters: &[f64],
    layout: &Layout,
) -> Result<Vec<FrameColumns>, Error> {
    let (free, nudges) = objective.split(parameters);
    let coefficients = objective.space.coefficients(free);
    let frames = (0..objective.frames.len()).into_par_iter().map(|index| {
        let measurable = objective.measurable(index, coefficients.as_slice(), nudges[index])?;
        let frame = &objective.frames[index];
        Ok(of_frame(frame, measurable, coefficients.as_slice(), nudges[index], (layout, index)))
    });
    frames.collect()
}

fn of_frame(
    frame: &Observation,
    measurable: Measurable<'_>,
    coefficients: &[f64],
    nudges: &[f64],
    (layout, index): (&Layout, usize),
) -> FrameColumns {
    let Measurable { nudged, mut rows, mut jacobian, .. } = measurable;
    frame.weigh(&mut rows, &mut jacobian);
    let model = nudged.model(coefficients);
    let mut row_of = vec![usize::MAX; frame.positions.len()];
    rows.iter().enumerate().for_each(|(row, (datum, ..))| row_of[*datum] = row);
    let mut of_cells = DMatrix::zeros(2 * rows.len(), layout.order());
    for (block, parameter) in layout.parameters.iter().enumerate() {
        let tessellation = &nudged.tessellation;
        let found = cell_derivatives(tessellation, &nudged.positions, &model, *parameter);
        for cell in 0..frame.positions.len() {
            let column = layout.block(block).start + layout.of_frames[index][cell];
            let mut add = |other: usize, slope: Vector<f64>| {
                if row_of[other] != usize::MAX {
                    of_cells[(2 * row_of[other], column)] += slope.x;
                    of_cells[(2 * row_of[other] + 1, column)] += slope.y;
                }
            };
            add(cell, found.on_cell[cell]);
            tessellation.ring(cell).for_each(|h| add(tessellation.neighbour(h), found.on_neighbour[h]));
        }
    }
    if frame.background_dimension() > 0 {
        for mut column in of_cells.column_iter_mut() {
            let mut field: Vec<Vector<f64>> =
                column.as_slice().chunks_exact(2).map(|v| Vector::new(v[0], v[1])).collect();
            frame.remove_background(&mut field);
            column.iter_mut().zip(field.iter().flatten()).for_each(|(to, from)| *to = *from);
        }
    }
    for (row, (datum, ..)) in rows.iter().enumerate() {
        let root = frame.weight(*datum).sqrt();
        of_cells.rows_mut(2 * row, 2).iter_mut().for_each(|entry| *entry *= root);
    }
    let p = rows.first().map_or(0, |(_, _, x)| x.ncols());
    let free = DMatrix::from_fn(2 * rows.len(), p, |i, k| rows[i / 2].2[(i % 2, k)]);
    let back: Vec<Vector<f64>> =
        rows.iter().map(|(datum, rest, _)| linearised_back(&jacobian, (*datum, *rest), nudges)).collect();
    let data = DVector::from_fn(2 * rows.len(), |i, _| back[i / 2][i % 2]);
    let datum_of: Vec<usize> = rows.iter().map(|row| row.0).collect();
    FrameColumns { coupled: coupled(&jacobian, &datum_of, &of_cells, nudges.len()), of_cells, free, data }
}

/// JᵀZ
fn coupled(jacobian: &BlockMatrix, rows: &[usize], of_cells: &DMatrix<f64>, order: usize) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(order, of_cells.ncols());
    for (k, mut column) in product.column_iter_mut().enumerate() {
        let z = of_cells.column(k);
        for (row, datum) in rows.iter().enumerate() {
            let (x, y) = (z[2 * row], z[2 * row + 1]);
            if x != 0.0 || y != 0.0 {
                for (cell, b) in jacobian.row(*datum) {
                    column[2 * cell] += b[0] * x + b[2] * y;
                    column[2 * cell + 1] += b[1] * x + b[3] * y;
                }
            }
        }
    }
    product
}
