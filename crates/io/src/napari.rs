//! Layers as napari keeps them: arrays of rows, of tracks (track, frame, (z,) y, x) or of points (frame, (z,)) y, x.

use std::ops::RangeInclusive;
use std::path::Path;

use ndarray::{ArrayView1, Axis, Ix2};

use crate::array::parse_reals;
use crate::error::{Error, ShapeFault, TableFault, table_error};
use crate::note::Note;
use crate::stated::Stated;
use crate::table::{Depths, Layout, Spot, SpotTable};

/// How a `.npy` file begins.
pub(crate) const SIGNATURE: &[u8] = b"\x93NUMPY";

/// Beyond this an f64 no longer holds every whole number.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// A kind of layer.
struct Layer {
    name: &'static str,
    widths: RangeInclusive<usize>,
    expected: &'static str,
    /// What stands before the coordinates.
    columns: &'static str,
}

const TRACKS: Layer = Layer {
    name: "tracks",
    widths: 4..=5,
    expected: "(rows, 4) or (rows, 5), rows of track, frame, (z,) y, x",
    columns: "track, frame, ",
};
const POINTS: Layer = Layer {
    name: "points",
    widths: 2..=4,
    expected: "(rows, 2), (rows, 3) or (rows, 4), rows of (frame, (z,)) y, x",
    columns: "frame, ",
};

/// Reads the data of a layer, of points where the layout says so, else of tracks; `path` only names the place.
///
/// The widest array has a depth. Points of two columns are of one frame, and points have no track.
pub(crate) fn read_layer(path: &Path, bytes: &[u8], layout: Layout) -> Result<SpotTable, Error> {
    let of_points = layout == Layout::Points;
    let Layer { name, widths, expected, columns } = if of_points { POINTS } else { TRACKS };
    let array = parse_reals(path, bytes)?;
    let found = array.shape().to_vec();
    let shape = |fault| Error::Shape { path: path.to_path_buf(), fault };
    let width = found.last().copied().unwrap_or_default();
    let array = match array.into_dimensionality::<Ix2>() {
        Ok(array) if widths.contains(&width) => array,
        _ => return Err(shape(ShapeFault::Dimensions { found, expected })),
    };
    if array.is_empty() {
        return Err(shape(ShapeFault::Nothing { found, axis: "rows" }));
    }
    let is_deep = width == *widths.end();
    let mut depths = Depths::default();
    let mut spots = Vec::with_capacity(array.nrows());
    for (index, row) in array.axis_iter(Axis(0)).enumerate() {
        let spot = || {
            Ok(Spot {
                track: if of_points { 0 } else { whole(index, row, 0)? },
                frame: match (of_points, width) {
                    (true, 2) => 0,
                    (true, _) => whole(index, row, 0)?,
                    (false, _) => whole(index, row, 1)?,
                },
                x: finite(index, row, width - 1)?,
                y: finite(index, row, width - 2)?,
            })
        };
        spots.push(spot().map_err(|fault| table_error(path, fault))?);
        depths.include(is_deep.then(|| row[width - 3]));
    }
    let before = if width == 2 { "" } else { columns };
    let depth = if is_deep { "z, " } else { "" };
    let mut notes = vec![Note::guessed(format!(
        "columns of the array are {before}{depth}y, x, as in a {name} layer of napari"
    ))];
    notes.extend(depths.note());
    Ok(SpotTable { spots, untracked: 0, stated: Stated::default(), notes })
}

/// A number of a row that counts something.
fn whole(index: usize, row: ArrayView1<'_, f64>, column: usize) -> Result<i64, TableFault> {
    let value = row[column];
    let is_whole = value.fract() == 0.0 && value.abs() < EXACT;
    let fault = TableFault::ArrayRow { row: index, column, value, expected: "a whole number" };
    is_whole.then_some(value as i64).ok_or(fault)
}

/// A coordinate of a row.
fn finite(index: usize, row: ArrayView1<'_, f64>, column: usize) -> Result<f64, TableFault> {
    let value = row[column];
    let fault = TableFault::ArrayRow { row: index, column, value, expected: "a finite number" };
    value.is_finite().then_some(value).ok_or(fault)
}
