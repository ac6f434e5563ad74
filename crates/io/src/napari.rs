//! Tracks as napari keeps them: an array of rows track, frame, (z,) y, x.

use std::path::Path;

use ndarray::{ArrayView1, Axis, Ix2};

use crate::array::parse_reals;
use crate::error::{Error, ShapeFault, TableFault};
use crate::note::Note;
use crate::stated::Stated;
use crate::table::{Depths, Spot, SpotTable};

/// How a `.npy` file begins.
pub(crate) const SIGNATURE: &[u8] = b"\x93NUMPY";

/// Beyond this an f64 no longer holds every whole number.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Reads the data of a tracks layer; `path` only names the place.
pub(crate) fn read_tracks_layer(path: &Path, bytes: &[u8]) -> Result<SpotTable, Error> {
    const EXPECTED: &str = "(rows, 4) or (rows, 5), rows of track, frame, (z,) y, x";
    let array = parse_reals(path, bytes)?;
    let found = array.shape().to_vec();
    let shape = |fault| Error::Shape { path: path.to_path_buf(), fault };
    let width = found.last().copied().unwrap_or_default();
    let array = match array.into_dimensionality::<Ix2>() {
        Ok(array) if matches!(width, 4 | 5) => array,
        _ => return Err(shape(ShapeFault::Dimensions { found, expected: EXPECTED })),
    };
    if array.is_empty() {
        return Err(shape(ShapeFault::Nothing { found, axis: "rows" }));
    }
    let mut depths = Depths::default();
    let mut spots = Vec::with_capacity(array.nrows());
    for (index, row) in array.axis_iter(Axis(0)).enumerate() {
        let spot =
            spot(index, row).map_err(|fault| Error::Table { path: path.to_path_buf(), line: None, fault })?;
        depths.include((width == 5).then(|| row[2]));
        spots.push(spot);
    }
    let order = if width == 5 { "track, frame, z, y, x" } else { "track, frame, y, x" };
    let mut notes =
        vec![Note::guessed(format!("columns of the array are {order}, as in a tracks layer of napari"))];
    notes.extend(depths.note());
    Ok(SpotTable { spots, untracked: 0, stated: Stated::default(), notes })
}

fn spot(index: usize, row: ArrayView1<'_, f64>) -> Result<Spot, TableFault> {
    let last = row.len() - 1;
    Ok(Spot {
        track: whole(index, row, 0)?,
        frame: whole(index, row, 1)?,
        x: finite(index, row, last)?,
        y: finite(index, row, last - 1)?,
    })
}

/// A number of a row that counts something.
pub(crate) fn whole(index: usize, row: ArrayView1<'_, f64>, column: usize) -> Result<i64, TableFault> {
    let value = row[column];
    let is_whole = value.fract() == 0.0 && value.abs() < EXACT;
    let fault = TableFault::ArrayRow { row: index, column, value, expected: "a whole number" };
    is_whole.then_some(value as i64).ok_or(fault)
}

/// A coordinate of a row.
pub(crate) fn finite(index: usize, row: ArrayView1<'_, f64>, column: usize) -> Result<f64, TableFault> {
    let value = row[column];
    let fault = TableFault::ArrayRow { row: index, column, value, expected: "a finite number" };
    value.is_finite().then_some(value).ok_or(fault)
}
