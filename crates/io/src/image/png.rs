//! PNG files: one image with the samples as they are in the file, never stretched to a full range.

use std::io::Cursor;
use std::path::Path;

use ndarray::Array3;
use png::{BitDepth, ColorType, Decoder, DecodingError};

use super::check_size;
use crate::error::{Error, ImageFault, image_error};

/// What the pixels of an image with a palette are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Indices {
    /// Numbers in their own right; the palette is there to look at.
    Numbers,
    /// Nothing but the names of colours.
    Colours,
}

/// One frame (1, rows, columns) of a grey image, or of one with a palette where that is allowed.
pub(super) fn parse_png(path: &Path, bytes: &[u8], indices: Indices) -> Result<Array3<u16>, Error> {
    let failure = |fault| image_error(path, fault);
    let broken = |error: DecodingError| {
        failure(ImageFault::Png { detail: error.to_string().trim_end_matches('.').to_owned() })
    };
    let mut decoder = Decoder::new(Cursor::new(bytes));
    let header = decoder.read_header_info().map_err(broken)?;
    let (columns, rows, depth) = (header.width, header.height, header.bit_depth);
    check_size(path, 0, [columns, rows])?;
    match header.color_type {
        ColorType::Grayscale => {}
        ColorType::Indexed if indices == Indices::Numbers => {}
        colour => {
            let colour = format!("{colour:?}({})", depth as u8);
            return Err(failure(ImageFault::Colour { page: 0, colour }));
        }
    }
    let mut reader = decoder.read_info().map_err(broken)?;
    if let Some(animation) = reader.info().animation_control() {
        return Err(failure(ImageFault::Animation { frames: animation.num_frames }));
    }
    let length = reader.output_buffer_size().ok_or_else(|| broken(DecodingError::LimitsExceeded))?;
    let mut buffer = vec![0; length];
    let line = reader.next_frame(&mut buffer).map_err(broken)?.line_size;
    // The pixels may all be there, and the end of the file not.
    reader.finish().map_err(broken)?;
    let pixels: Vec<u16> =
        buffer.chunks(line).flat_map(|row| samples(row, depth, columns as usize)).collect();
    let found = pixels.len();
    Array3::from_shape_vec((1, rows as usize, columns as usize), pixels).map_err(|_| {
        failure(ImageFault::Png { detail: format!("{found} pixels do not fill {columns} × {rows}") })
    })
}

/// The samples of a row, which begin with the highest bits of a byte and with the higher byte of two.
fn samples(row: &[u8], depth: BitDepth, columns: usize) -> Vec<u16> {
    let bits = depth as usize;
    if bits == 16 {
        return row.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect();
    }
    let mask = (1_u16 << bits) - 1;
    let shifts = (0..8 / bits).rev().map(|place| place * bits);
    let of_byte = |&byte: &u8| shifts.clone().map(move |shift| (u16::from(byte) >> shift) & mask);
    row.iter().flat_map(of_byte).take(columns).collect()
}
