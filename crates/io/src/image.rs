//! Images with one number for each pixel: `.npy` arrays and TIFF.

use std::io::Cursor;
use std::path::Path;

use ndarray::{Array3, ArrayD, Axis, Ix3};
use tiff::decoder::{Decoder, DecodingResult};
use tiff::{ColorType, TiffError};

use crate::array::{parse_integers, parse_reals};
use crate::error::{Error, FormatFault, ImageFault, ShapeFault};
use crate::tracks::SIZE_LIMIT;

/// Labels (frames, rows, columns), 0 for background; one image is one frame.
pub(crate) fn parse_labels(path: &Path, bytes: &[u8]) -> Result<Array3<i64>, Error> {
    let labels = match kind(path, bytes)? {
        Kind::Array => stack(path, parse_integers(path, bytes).map_err(as_image_fault)?)?,
        Kind::Tiff => parse_tiff(path, bytes, integers)?,
    };
    let negative = labels.indexed_iter().find(|&(_, &label)| label < 0);
    match negative {
        Some(((frame, row, column), &label)) => {
            Err(image_error(path, ImageFault::NegativeLabel { frame, row, column, label }))
        }
        None => Ok(labels),
    }
}

/// A field (frames, rows, columns), finite everywhere; one image is one frame.
pub(crate) fn parse_field_images(path: &Path, bytes: &[u8]) -> Result<Array3<f64>, Error> {
    let field = match kind(path, bytes)? {
        Kind::Array => stack(path, parse_reals(path, bytes).map_err(as_image_fault)?)?,
        Kind::Tiff => parse_tiff(path, bytes, reals)?,
    };
    let missing = field.indexed_iter().find(|(_, value)| !value.is_finite());
    match missing {
        Some(((frame, row, column), &value)) => {
            Err(image_error(path, ImageFault::NotFinite { frame, row, column, value }))
        }
        None => Ok(field),
    }
}

pub(crate) fn image_error(path: &Path, fault: ImageFault) -> Error {
    Error::Image { path: path.to_path_buf(), fault }
}

enum Kind {
    Array,
    Tiff,
}

fn kind(path: &Path, bytes: &[u8]) -> Result<Kind, Error> {
    let is = |signature: &[u8]| bytes.starts_with(signature);
    if is(b"II*\0") || is(b"MM\0*") || is(b"II+\0") || is(b"MM\0+") {
        Ok(Kind::Tiff)
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
        Some('O') => Error::Image { path, fault: ImageFault::Pickled },
        Some('f') => Error::Image { path, fault: ImageFault::RealLabels { found } },
        _ => Error::Format { path, fault: FormatFault::UnsupportedType { found, needed } },
    }
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

/// The pages of a TIFF file, each a frame.
fn parse_tiff<T: Clone>(
    path: &Path,
    bytes: &[u8],
    numbers: fn(DecodingResult) -> Result<Vec<T>, ImageFault>,
) -> Result<Array3<T>, Error> {
    let failure = |fault| image_error(path, fault);
    let mut page = 0;
    let broken = |page: usize| {
        move |error: TiffError| image_error(path, ImageFault::Tiff { page, detail: error.to_string() })
    };
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(broken(0))?;
    let (mut pixels, mut first): (Vec<T>, Option<[usize; 2]>) = (Vec::new(), None);
    loop {
        let (columns, rows) = decoder.dimensions().map_err(broken(page))?;
        let size = [columns as usize, rows as usize];
        let expected = *first.get_or_insert(size);
        if size != expected {
            return Err(failure(ImageFault::OtherSize { page, found: size, expected }));
        }
        // Before anything is allocated for the pixels.
        let needed = 8 * (page as u64 + 1) * u64::from(columns) * u64::from(rows);
        if needed > SIZE_LIMIT {
            return Err(failure(ImageFault::TooLarge { page, size, bytes: needed, limit: SIZE_LIMIT }));
        }
        match decoder.colortype().map_err(broken(page))? {
            ColorType::Gray(_) => {}
            colour => return Err(failure(ImageFault::Colour { page, colour: format!("{colour:?}") })),
        }
        pixels.extend(numbers(decoder.read_image().map_err(broken(page))?).map_err(failure)?);
        page += 1;
        if !decoder.more_images() {
            break;
        }
        decoder.next_image().map_err(broken(page))?;
    }
    let [columns, rows] = first.unwrap_or_default();
    let found = pixels.len();
    Array3::from_shape_vec((page, rows, columns), pixels).map_err(|_| {
        failure(ImageFault::Tiff { page: 0, detail: format!("{found} pixels do not fill {page} pages") })
    })
}

fn integers(pixels: DecodingResult) -> Result<Vec<i64>, ImageFault> {
    let real = |found: &str| Err(ImageFault::RealLabels { found: found.to_owned() });
    Ok(match pixels {
        DecodingResult::U8(values) => values.into_iter().map(i64::from).collect(),
        DecodingResult::U16(values) => values.into_iter().map(i64::from).collect(),
        DecodingResult::U32(values) => values.into_iter().map(i64::from).collect(),
        // Labels beyond i64 are told as negative ones, which they are when read as signed.
        DecodingResult::U64(values) => values.into_iter().map(|value| value as i64).collect(),
        DecodingResult::I8(values) => values.into_iter().map(i64::from).collect(),
        DecodingResult::I16(values) => values.into_iter().map(i64::from).collect(),
        DecodingResult::I32(values) => values.into_iter().map(i64::from).collect(),
        DecodingResult::I64(values) => values,
        DecodingResult::F16(_) => return real("float16"),
        DecodingResult::F32(_) => return real("float32"),
        DecodingResult::F64(_) => return real("float64"),
    })
}

fn reals(pixels: DecodingResult) -> Result<Vec<f64>, ImageFault> {
    Ok(match pixels {
        DecodingResult::F16(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F32(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F64(values) => values,
        DecodingResult::U64(values) => values.into_iter().map(|value| value as f64).collect(),
        whole => integers(whole)?.into_iter().map(|value| value as f64).collect(),
    })
}
