//! Pages of TIFF files.

use std::io::Cursor;
use std::path::Path;

use ndarray::Array3;
use tiff::decoder::ifd::Value;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError, TiffUnsupportedError};

use super::description::{Tags, describe, has_frames_as_planes};
use super::{Images, check_size};
use crate::error::{Error, ImageFault, image_error};
use crate::memory::SIZE_LIMIT;

/// The pages of a TIFF file, each a frame.
pub(super) fn parse_tiff<T: Clone>(
    path: &Path,
    bytes: &[u8],
    numbers: fn(DecodingResult) -> Result<Vec<T>, ImageFault>,
) -> Result<Images<T>, Error> {
    let failure = |fault| image_error(path, fault);
    let unpacked = super::zstd::unpacked(bytes)
        .map_err(|detail| failure(ImageFault::Tiff { page: 0, detail: format!("Zstandard: {detail}") }))?;
    let bytes = unpacked.as_deref().unwrap_or(bytes);
    let mut page = 0;
    let broken = |page: usize| {
        move |error: TiffError| {
            image_error(
                path,
                match error {
                    TiffError::UnsupportedError(TiffUnsupportedError::UnsupportedCompressionMethod(
                        method,
                    )) => ImageFault::Compression { page, method: format!("{method:?}") },
                    other => ImageFault::Tiff { page, detail: other.to_string() },
                },
            )
        }
    };
    // The size of pages is checked below; what is read on the way to their pixels is never more than the file.
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(SIZE_LIMIT).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = limits.intermediate_buffer_size.max(bytes.len());
    limits.ifd_value_size = limits.ifd_value_size.max(bytes.len());
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(broken(0))?.with_limits(limits);
    let tags = tags_of(&mut decoder);
    let (mut pixels, mut first): (Vec<T>, Option<[usize; 2]>) = (Vec::new(), None);
    loop {
        let (columns, rows) = decoder.dimensions().map_err(broken(page))?;
        let size = [columns as usize, rows as usize];
        let expected = *first.get_or_insert(size);
        if size != expected {
            return Err(failure(ImageFault::OtherSize { page, found: size, expected }));
        }
        check_size(path, page, [columns, rows])?;
        match decoder.colortype().map_err(broken(page))? {
            ColorType::Gray(_) => {}
            ColorType::RGB(_) if has_frames_as_planes(&tags, 3) => {
                return Err(failure(ImageFault::FramesAsPlanes { frames: 3 }));
            }
            ColorType::RGBA(_) if has_frames_as_planes(&tags, 4) => {
                return Err(failure(ImageFault::FramesAsPlanes { frames: 4 }));
            }
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
    let described = describe(&tags, page).map_err(failure)?;
    let found = pixels.len();
    let pixels = Array3::from_shape_vec((page, rows, columns), pixels).map_err(|_| {
        failure(ImageFault::Tiff { page: 0, detail: format!("{found} pixels do not fill {page} pages") })
    })?;
    Ok(Images { pixels, described })
}

/// What the first page says; tags that cannot be read say nothing.
fn tags_of(decoder: &mut Decoder<Cursor<&[u8]>>) -> Tags {
    let mut real = |tag| {
        let value = decoder.find_tag(tag).ok().flatten()?;
        let number = match value {
            Value::Rational(over, under) => f64::from(over) / f64::from(under),
            other => other.into_f64().ok()?,
        };
        (number.is_finite() && number > 0.0).then_some(number)
    };
    let resolution = real(Tag::XResolution).zip(real(Tag::YResolution)).map(|(x, y)| [x, y]);
    Tags {
        description: decoder.get_tag_ascii_string(Tag::ImageDescription).unwrap_or_default(),
        resolution,
        unit: decoder.find_tag_unsigned(Tag::ResolutionUnit).ok().flatten(),
    }
}

pub(super) fn integers(pixels: DecodingResult) -> Result<Vec<i64>, ImageFault> {
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

pub(super) fn reals(pixels: DecodingResult) -> Result<Vec<f64>, ImageFault> {
    Ok(match pixels {
        DecodingResult::F16(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F32(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F64(values) => values,
        DecodingResult::U64(values) => values.into_iter().map(|value| value as f64).collect(),
        whole => integers(whole)?.into_iter().map(|value| value as f64).collect(),
    })
}
