//! Fields of vectors to and from arrays (N, 2).

use crate::error::fault;
use ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use voronudge::Vector;

/// The vectors of an array (N, 2).
pub(crate) fn vectors(
    py: Python<'_>,
    name: &str,
    array: &PyReadonlyArray2<'_, f64>,
) -> PyResult<Vec<Vector<f64>>> {
    if array.shape()[1] != 2 {
        let shape = array.shape();
        return Err(fault(
            py,
            format!("{name} has shape ({}, {}), but it must be (cells, 2)", shape[0], shape[1]),
            Some("give x and y of each cell"),
        ));
    }
    Ok(array.as_array().rows().into_iter().map(|row| Vector::new(row[0], row[1])).collect())
}

/// As [`vectors`], of a number that is known.
pub(crate) fn field(
    py: Python<'_>,
    name: &str,
    array: &PyReadonlyArray2<'_, f64>,
    cells: usize,
) -> PyResult<Vec<Vector<f64>>> {
    let found = vectors(py, name, array)?;
    match found.len() == cells {
        true => Ok(found),
        false => Err(fault(
            py,
            format!("{name} has {} rows, but there are {cells} cells", found.len()),
            Some("give one row for each cell"),
        )),
    }
}

/// An array (N, 2) of vectors.
pub(crate) fn array<'py>(
    py: Python<'py>,
    vectors: impl IntoIterator<Item = Vector<f64>>,
) -> Bound<'py, PyArray2<f64>> {
    // Pairs, for which an iterator knows its length; two numbers for each row: the shape always fits.
    let flat = vectors.into_iter().map(|v| [v.x, v.y]).collect::<Vec<_>>().into_flattened();
    Array2::from_shape_vec((flat.len() / 2, 2), flat).unwrap_or_default().into_pyarray(py)
}
