//! What the parameters of single cells do to what is measured.

use crate::objective::{Measurable, Objective};
use crate::own_parts::Layout;
use crate::rows::linearised_back;
use crate::{Error, Observation};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::{BlockMatrix, cell_derivatives};

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
    about(objective, parameters, |index, linear| of_parameters(linear, layout, index))
}

/// The same for a smooth velocity, as a sum of patches of a width.
pub(super) fn columns_of_field(
    objective: &Objective<'_>,
    parameters: &[f64],
    (layout, width): (&Layout, f64),
) -> Result<Vec<FrameColumns>, Error> {
    about(objective, parameters, |index, linear| of_patches(linear, (layout, width), index))
}

/// A frame linearised about a point.
struct Linear<'a> {
    frame: &'a Observation,
    measurable: Measurable<'a>,
    coefficients: &'a [f64],
    /// The row of each datum; none is as large as [`usize::MAX`].
    row_of: Vec<usize>,
}

/// All frames with the columns that `of_cells` makes of them.
fn about(
    objective: &Objective<'_>,
    parameters: &[f64],
    of_cells: impl Fn(usize, &Linear<'_>) -> DMatrix<f64> + Sync,
) -> Result<Vec<FrameColumns>, Error> {
    let (free, nudges) = objective.split(parameters);
    let coefficients = objective.space.coefficients(free);
    let frames = (0..objective.frames.len()).into_par_iter().map(|index| {
        let frame = &objective.frames[index];
        let mut measurable = objective.measurable(index, coefficients.as_slice(), nudges[index])?;
        frame.weigh(&mut measurable.rows, &mut measurable.jacobian);
        let mut row_of = vec![usize::MAX; frame.velocities.values().len()];
        measurable.rows.iter().enumerate().for_each(|(row, (datum, ..))| row_of[*datum] = row);
        let linear = Linear { frame, measurable, coefficients: coefficients.as_slice(), row_of };
        let of_cells = of_cells(index, &linear);
        Ok(linear.with(of_cells, nudges[index]))
    });
    frames.collect()
}

/// What the parameters of single cells do.
fn of_parameters(linear: &Linear<'_>, layout: &Layout, index: usize) -> DMatrix<f64> {
    let Linear { frame, measurable, coefficients, row_of } = linear;
    let nudged = &measurable.nudged;
    let model = nudged.model(coefficients);
    let mut of_cells = DMatrix::zeros(2 * measurable.rows.len(), layout.order());
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
    of_cells
}

/// Velocities that fall off with the distance from each cell, along x and along y.
fn of_patches(linear: &Linear<'_>, (layout, width): (&Layout, f64), index: usize) -> DMatrix<f64> {
    let Linear { frame, measurable, row_of, .. } = linear;
    let domain = frame.tessellation.domain();
    let mut of_cells = DMatrix::zeros(2 * measurable.rows.len(), layout.order());
    for (cell, centre) in frame.positions.iter().enumerate() {
        for (datum, row) in row_of.iter().enumerate().filter(|own| *own.1 != usize::MAX) {
            let away = domain.shortest(frame.position_of_datum(datum) - centre).norm_squared();
            let value = (-0.5 * away / (width * width)).exp();
            for (block, start) in [layout.block(0).start, layout.block(1).start].into_iter().enumerate() {
                of_cells[(2 * row + block, start + layout.of_frames[index][cell])] = value;
            }
        }
    }
    of_cells
}

impl Linear<'_> {
    /// The columns of one frame as they are measured and weighed.
    fn with(self, mut of_cells: DMatrix<f64>, nudges: &[f64]) -> FrameColumns {
        let Self { frame, measurable: Measurable { rows, jacobian, .. }, .. } = self;
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
