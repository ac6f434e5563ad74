//! Eigenvalues, character and modes as files.

use super::frame::Solved;
use crate::failure::Failure;
use ndarray::{Array2, Array3, Array4};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_spectrum::{Localisation, Mode};

/// What a file says of each mode.
type Column = fn(&Mode) -> Option<f64>;

/// What a file says of where between walls each mode is.
type Columns = fn(&Localisation) -> [f64; 2];

/// Files with the modes along the axis behind that of frames, which a data set with a single frame does not have.
pub(super) fn write(
    out: &mut OutputDirectory,
    data: &DataSet,
    solved: &[Solved],
    with_modes: bool,
) -> Result<(), Failure> {
    let most = solved.iter().map(|one| one.modes.modes.len()).max().unwrap_or(0);
    let mut values = Array3::from_elem((solved.len(), most, 2), f64::NAN);
    for (frame, one) in solved.iter().enumerate() {
        for (row, mode) in one.modes.modes.iter().enumerate() {
            values[(frame, row, 0)] = mode.value.re;
            values[(frame, row, 1)] = mode.value.im;
        }
    }
    out.write_array("eigenvalues.npy", shaped(data, solved, values).view())?;
    let columns: [(&str, Column); 3] = [
        ("participation.npy", |mode| mode.participation),
        ("longitudinal.npy", |mode| mode.longitudinal),
        ("condition.npy", |mode| mode.condition),
    ];
    for (name, column) in columns {
        let known = solved.iter().any(|one| one.modes.modes.iter().any(|mode| column(mode).is_some()));
        if !known {
            continue;
        }
        let mut array = Array2::from_elem((solved.len(), most), f64::NAN);
        for (frame, one) in solved.iter().enumerate() {
            for (row, mode) in one.modes.modes.iter().enumerate() {
                array[(frame, row)] = column(mode).unwrap_or(f64::NAN);
            }
        }
        out.write_array(name, shaped(data, solved, array).view())?;
    }
    if solved.iter().all(|one| one.localised.is_some()) {
        let of = |frame: usize, row: usize| {
            solved[frame].localised.as_ref().and_then(|own| own.modes.get(row).copied())
        };
        let tables: [(&str, Columns); 2] =
            [("edge.npy", |own| [own.edge, own.side]), ("localisation.npy", |own| [own.centre, own.growth])];
        for (name, columns) in tables {
            let array = Array3::from_shape_fn((solved.len(), most, 2), |(frame, row, column)| {
                of(frame, row).map_or(f64::NAN, |own| columns(&own)[column])
            });
            out.write_array(name, shaped(data, solved, array).view())?;
        }
    }
    if let (true, Some(first)) = (with_modes, solved.first()) {
        out.write_array("modes.npy", vectors(data, first).view())?;
    }
    Ok(())
}

/// Without the axis of frames if a single one was looked at.
fn shaped<D: ndarray::RemoveAxis>(
    data: &DataSet,
    solved: &[Solved],
    array: ndarray::Array<f64, D>,
) -> ndarray::ArrayD<f64> {
    if solved.len() == 1 {
        array.index_axis_move(ndarray::Axis(0), 0).into_dyn()
    } else {
        data.as_given(array)
    }
}

/// Displacements (modes, N, 2, 2); zero for cells that are held, NaN for absent ones.
fn vectors(data: &DataSet, solved: &Solved) -> Array4<f64> {
    let count = solved.modes.modes.len();
    let flip = data.y_sign();
    let mut array = Array4::from_elem((count, data.cells(), 2, 2), f64::NAN);
    for mode in 0..count {
        for &cell in &solved.snapshot.cells {
            for axis in 0..2 {
                (array[(mode, cell, axis, 0)], array[(mode, cell, axis, 1)]) = (0.0, 0.0);
            }
        }
        let Some(u) = solved.modes.vector(mode) else { continue };
        for (index, &moving) in solved.problem.cells().iter().enumerate() {
            let cell = solved.snapshot.cells[moving];
            for (axis, sign) in [1.0, flip].into_iter().enumerate() {
                let entry = u[2 * index + axis] * sign;
                (array[(mode, cell, axis, 0)], array[(mode, cell, axis, 1)]) = (entry.re, entry.im);
            }
        }
    }
    array
}
