//! Images with one number for each pixel: `.npy` arrays, TIFF and PNG.

mod description;
mod png;
mod tiff;
mod zstd;

use std::path::Path;

use ndarray::{Array3, ArrayD, Axis, Ix3};

pub(crate) use self::description::Described;
use self::png::{Indices, parse_png};
use self::tiff::{integers, parse_tiff, reals};
use crate::array::{parse_integers, parse_reals, pickled};
use crate::cellpose::read_masks;
use crate::error::{Error, FormatFault, ImageFault, ShapeFault, image_error};
use crate::memory::{SIZE_LIMIT, machine_memory};
use crate::note::Note;

/// Memory that an image takes while it is read and searched, in 8 bytes for each pixel.
const COPIES: u64 = 6;

/// What is looked for in a folder that holds both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    Labels,
    Field,
}

/// The frames of a file (frames, rows, columns), and what it says of them.
pub(crate) struct Images<T> {
    pub(crate) pixels: Array3<T>,
    pub(crate) described: Described,
}

impl<T> From<Array3<T>> for Images<T> {
    fn from(pixels: Array3<T>) -> Self {
        Self { pixels, described: Described::default() }
    }
}

/// Labels (frames, rows, columns), 0 for background; one image is one frame.
pub(crate) fn parse_labels(path: &Path, bytes: &[u8]) -> Result<Images<i64>, Error> {
    let labels = match kind(path, bytes)? {
        Kind::Array => match pickled(bytes) {
            Some(body) => of_cellpose(stack(path, read_masks(path, body)?)?),
            None => stack(path, parse_integers(path, bytes).map_err(as_image_fault)?)?.into(),
        },
        Kind::Tiff => parse_tiff(path, bytes, integers).map_err(as_picture)?,
        Kind::Png => parse_png(path, bytes, Indices::Numbers).map_err(as_picture)?.mapv(i64::from).into(),
    };
    let negative = labels.pixels.indexed_iter().find(|&(_, &label)| label < 0);
    match negative {
        Some(((frame, row, column), &label)) => {
            Err(image_error(path, ImageFault::NegativeLabel { frame, row, column, label }))
        }
        None => Ok(labels),
    }
}

/// Masks of Cellpose, which works on images and on volumes.
fn of_cellpose(pixels: Array3<i64>) -> Images<i64> {
    let mut notes = vec![Note::read("the masks of Cellpose")];
    if pixels.dim().0 > 1 {
        notes.push(Note::doubtful("masks of several planes (Cellpose) are taken for frames in time"));
    }
    Images { pixels, described: Described { notes, ..Described::default() } }
}

/// A field (frames, rows, columns), finite everywhere; one image is one frame.
pub(crate) fn parse_field_images(path: &Path, bytes: &[u8]) -> Result<Images<f64>, Error> {
    let field = match kind(path, bytes)? {
        Kind::Array => stack(path, parse_reals(path, bytes).map_err(as_image_fault)?)?.into(),
        Kind::Tiff => parse_tiff(path, bytes, reals)?,
        Kind::Png => parse_png(path, bytes, Indices::Colours)?.mapv(f64::from).into(),
    };
    let missing = field.pixels.indexed_iter().find(|(_, value)| !value.is_finite());
    match missing {
        Some(((frame, row, column), &value)) => {
            Err(image_error(path, ImageFault::NotFinite { frame, row, column, value }))
        }
        None => Ok(field),
    }
}

/// Whether a file begins like a TIFF or a PNG image.
pub(crate) fn is_image(bytes: &[u8]) -> bool {
    matches!(kind(Path::new(""), bytes), Ok(Kind::Tiff | Kind::Png))
}

enum Kind {
    Array,
    Tiff,
    Png,
}

fn kind(path: &Path, bytes: &[u8]) -> Result<Kind, Error> {
    let is = |signature: &[u8]| bytes.starts_with(signature);
    if is(b"II*\0") || is(b"MM\0*") || is(b"II+\0") || is(b"MM\0+") {
        Ok(Kind::Tiff)
    } else if is(b"\x89PNG\r\n\x1a\n") {
        Ok(Kind::Png)
    } else if is(b"\x93NUMPY") || bytes.is_empty() {
        Ok(Kind::Array)
    } else {
        Err(image_error(path, ImageFault::UnknownFormat))
    }
}

/// Tells pickled objects and labels with fractions from other arrays that cannot be read.
fn as_image_fault(error: Error) -> Error {
    let Error::Format { path, fault: FormatFault::UnsupportedType { found, needed } } = error else {
        return error;
    };
    match found.trim_start_matches(['<', '>', '|', '=']).chars().next() {
        Some('O') => {
            let detail = "only labels are looked for in one".into();
            Error::Image { path, fault: ImageFault::Pickled { detail } }
        }
        Some('f') => Error::Image { path, fault: ImageFault::RealLabels { found } },
        _ => Error::Format { path, fault: FormatFault::UnsupportedType { found, needed } },
    }
}

/// Colours in place of labels: no channel of them can be taken for the labels.
fn as_picture(error: Error) -> Error {
    match error {
        Error::Image { path, fault: ImageFault::Colour { page, colour } } => {
            Error::Image { path, fault: ImageFault::PictureOfLabels { page, colour } }
        }
        other => other,
    }
}

/// Refuses pages that do not fit in memory, before anything is allocated for their pixels.
fn check_size(path: &Path, page: usize, size: [u32; 2]) -> Result<(), Error> {
    check_total(path, page + 1, size.map(|length| length as usize))
}

/// The same of all pages so far.
pub(crate) fn check_total(path: &Path, pages: usize, size: [usize; 2]) -> Result<(), Error> {
    let [columns, rows] = size.map(|length| length as u64);
    let needed = (pages as u64).saturating_mul(columns.saturating_mul(rows)).saturating_mul(8);
    let limit = machine_memory().map_or(SIZE_LIMIT, |memory| SIZE_LIMIT.min(memory / COPIES));
    if needed > limit {
        let fault = ImageFault::TooLarge { page: pages.saturating_sub(1), size, bytes: needed, limit };
        return Err(image_error(path, fault));
    }
    Ok(())
}

fn stack<T: Clone>(path: &Path, array: ArrayD<T>) -> Result<Array3<T>, Error> {
    const EXPECTED: &str = "(ny, nx) or (frames, ny, nx)";
    let found = array.shape().to_vec();
    let failure = |fault| Error::Shape { path: path.to_path_buf(), fault };
    let array = if found.len() == 2 { array.insert_axis(Axis(0)) } else { array };
    let Ok(array) = array.into_dimensionality::<Ix3>() else {
        return Err(failure(ShapeFault::Dimensions { found, expected: EXPECTED }));
    };
    let (frames, rows, columns) = array.dim();
    for (length, axis) in [(frames, "frames"), (rows, "rows"), (columns, "columns")] {
        if length == 0 {
            return Err(failure(ShapeFault::Nothing { found, axis }));
        }
    }
    Ok(array)
}
