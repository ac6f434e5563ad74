//! Reading and writing `.npy` arrays.
//!
//! Any C or Fortran order, little or big endian, format versions 1 to 3. The header is checked
//! against the length of the file before anything is allocated for the elements.

mod header;
mod item;

use std::io;
use std::path::Path;

use ndarray::{Array3, Array4, ArrayD, ArrayView, Axis, Dimension, Ix3, Ix4, IxDyn, ShapeBuilder};
use ndarray_npy::{WritableElement, WriteNpyError, WriteNpyExt};

use crate::error::{Error, FormatFault, ShapeFault};
use crate::input::read_bytes;
use header::Header;

/// Reads real numbers: float32, float64, or integers of up to 64 bits, as f64.
///
/// Returns the array in standard (C) order with the shape of the file. NaN and infinities are
/// handed on; what they mean is for the caller to decide.
///
/// # Errors
/// [`Error::File`] where the file cannot be read, [`Error::Format`] where it is no `.npy` array
/// of real numbers or its length does not agree with its header.
pub fn read_reals(path: &Path) -> Result<ArrayD<f64>, Error> {
    parse_reals(path, &read_bytes(path)?)
}

/// Reads integers of up to 64 bits, signed or unsigned, as i64.
///
/// Returns the array in standard (C) order with the shape of the file.
///
/// # Errors
/// As [`read_reals`]; also for elements that are not integers or exceed `i64::MAX`.
pub fn read_integers(path: &Path) -> Result<ArrayD<i64>, Error> {
    parse_integers(path, &read_bytes(path)?)
}

/// Reads plane vectors: shape (cells, 2) or (frames, cells, 2), the former as one frame.
///
/// # Errors
/// As [`read_reals`]; [`Error::Shape`] for another number of dimensions, a last axis that is not
/// of length 2, no frames or no cells.
pub fn read_vectors(path: &Path) -> Result<Array3<f64>, Error> {
    parse_vectors(path, &read_bytes(path)?)
}

/// [`read_reals`] from bytes already read; `path` only names the place.
pub(crate) fn parse_reals(path: &Path, bytes: &[u8]) -> Result<ArrayD<f64>, Error> {
    let parse = || {
        let (header, body) = Header::parse(bytes)?;
        assemble(&header, header.item.reals(body))
    };
    parse().map_err(|fault| format_error(path, fault))
}

/// [`read_integers`] from bytes already read; `path` only names the place.
pub(crate) fn parse_integers(path: &Path, bytes: &[u8]) -> Result<ArrayD<i64>, Error> {
    let parse = || {
        let (header, body) = Header::parse(bytes)?;
        assemble(&header, header.item.integers(body)?)
    };
    parse().map_err(|fault| format_error(path, fault))
}

/// Whether an array holds Python objects, and then the bytes of their pickle.
pub(crate) fn pickled(bytes: &[u8]) -> Option<&[u8]> {
    header::pickled(bytes)
}

/// Integers of a type such as `<u2` from their bytes, in the shape that they should have.
pub(crate) fn integers_of(
    item: &str,
    shape: Vec<usize>,
    fortran_order: bool,
    body: &[u8],
) -> Result<ArrayD<i64>, FormatFault> {
    let header = Header::of(item, shape, fortran_order, body)?;
    assemble(&header, header.item.integers(body)?)
}

/// [`read_vectors`] from bytes already read; `path` only names the place.
pub(crate) fn parse_vectors(path: &Path, bytes: &[u8]) -> Result<Array3<f64>, Error> {
    const EXPECTED: &str = "(cells, 2) or (frames, cells, 2)";
    let array = parse_reals(path, bytes)?;
    let found = array.shape().to_vec();
    let failure = |fault| Error::Shape { path: path.to_path_buf(), fault };
    let dimensions = |found| failure(ShapeFault::Dimensions { found, expected: EXPECTED });
    let array = match found.len() {
        2 => array.insert_axis(Axis(0)),
        3 => array,
        _ => return Err(dimensions(found)),
    };
    let array = array.into_dimensionality::<Ix3>().map_err(|_| dimensions(found.clone()))?;
    let (frames, cells, components) = array.dim();
    if components != 2 {
        let expected = EXPECTED;
        return Err(failure(ShapeFault::NotPairs { found, expected }));
    }
    for (length, axis) in [(frames, "frames"), (cells, "cells")] {
        if length == 0 {
            return Err(failure(ShapeFault::Nothing { found, axis }));
        }
    }
    Ok(array)
}

/// Vectors on a grid: shape (ny, nx, 2) or (frames, ny, nx, 2), the former as one frame.
pub(crate) fn parse_field(path: &Path, bytes: &[u8]) -> Result<Array4<f64>, Error> {
    const EXPECTED: &str = "(ny, nx, 2) or (frames, ny, nx, 2)";
    let array = parse_reals(path, bytes)?;
    let found = array.shape().to_vec();
    let failure = |fault| Error::Shape { path: path.to_path_buf(), fault };
    let dimensions = |found| failure(ShapeFault::Dimensions { found, expected: EXPECTED });
    let array = match found.len() {
        3 => array.insert_axis(Axis(0)),
        4 => array,
        _ => return Err(dimensions(found)),
    };
    let array = array.into_dimensionality::<Ix4>().map_err(|_| dimensions(found.clone()))?;
    let (frames, rows, columns, components) = array.dim();
    if components != 2 {
        let expected = EXPECTED;
        return Err(failure(ShapeFault::NotPairs { found, expected }));
    }
    for (length, axis) in [(frames, "frames"), (rows, "rows"), (columns, "columns")] {
        if length == 0 {
            return Err(failure(ShapeFault::Nothing { found, axis }));
        }
    }
    Ok(array)
}

/// Numbers in a row; `expected` is the shape in words.
pub(crate) fn parse_row(path: &Path, bytes: &[u8], expected: &'static str) -> Result<Vec<f64>, Error> {
    let array = parse_reals(path, bytes)?;
    if array.ndim() != 1 {
        let fault = ShapeFault::Dimensions { found: array.shape().to_vec(), expected };
        return Err(Error::Shape { path: path.to_path_buf(), fault });
    }
    Ok(array.iter().copied().collect())
}

/// Writes an array as `.npy` in its own memory order.
pub(crate) fn write_npy<W, A, D>(writer: W, array: ArrayView<'_, A, D>) -> io::Result<()>
where
    W: io::Write,
    A: WritableElement,
    D: Dimension,
{
    array.write_npy(writer).map_err(|error| match error {
        WriteNpyError::Io(source) => source,
        other => io::Error::other(other),
    })
}

/// Gives the elements, in file order, the shape and order that the header states.
fn assemble<T: Clone>(header: &Header, elements: Vec<T>) -> Result<ArrayD<T>, FormatFault> {
    let shape = IxDyn(&header.shape).set_f(header.fortran_order);
    let array = ArrayD::from_shape_vec(shape, elements).map_err(|error| {
        // Only shapes such as (0, 2^63) come here: no elements, yet not representable.
        FormatFault::HeaderMalformed { detail: format!("impossible shape {:?}: {error}", header.shape) }
    })?;
    Ok(array.as_standard_layout().into_owned())
}

fn format_error(path: &Path, fault: FormatFault) -> Error {
    Error::Format { path: path.to_path_buf(), fault }
}
