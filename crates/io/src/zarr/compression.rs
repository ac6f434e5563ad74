//! What Zstandard and other programs have packed, up to a size.

use std::io::Read;

use ruzstd::decoding::StreamingDecoder;

use super::Fault;

/// What Zstandard has packed.
pub(super) fn unpacked(bytes: &[u8], most: usize) -> Result<Vec<u8>, Fault> {
    inflated(StreamingDecoder::new(bytes).map_err(|error| error.to_string())?, most)
}

/// All that a reader has, if it is no more than `most` bytes.
pub(super) fn inflated(reader: impl Read, most: usize) -> Result<Vec<u8>, Fault> {
    let mut own = Vec::new();
    reader.take(most as u64 + 1).read_to_end(&mut own).map_err(|error| error.to_string())?;
    match own.len() <= most {
        true => Ok(own),
        false => Err(format!("a chunk has more than the {most} bytes that it should have")),
    }
}
