//! How the chunks of a store are compressed.

use std::io::Read;

use flate2::read::{MultiGzDecoder, ZlibDecoder};
use ruzstd::decoding::StreamingDecoder;
use serde_json::Value;

use super::metadata::Layout;
use super::{Fault, blosc};

/// A step from the bytes of a chunk to those of its file.
#[derive(Debug, Clone)]
pub(super) enum Codec {
    Zstd,
    Gzip,
    Zlib,
    Blosc,
    /// Four bytes at the end.
    Checksum,
    /// Smaller chunks in one file, with a list of their places at its end or at its beginning.
    Shards {
        inner: Box<Layout>,
        index_bytes: usize,
        is_index_first: bool,
    },
}

impl Codec {
    /// By the name that a store gives it.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "zstd" | "numcodecs.zstd" => Self::Zstd,
            "gzip" | "numcodecs.gzip" => Self::Gzip,
            "zlib" | "numcodecs.zlib" => Self::Zlib,
            "blosc" | "numcodecs.blosc" => Self::Blosc,
            "crc32c" => Self::Checksum,
            _ => return None,
        })
    }

    /// The bytes before this step, no more than `most`.
    pub(super) fn decode(&self, bytes: Vec<u8>, most: usize) -> Result<Vec<u8>, Fault> {
        match self {
            Self::Zstd => unpacked(&bytes, most),
            Self::Gzip => inflated(MultiGzDecoder::new(bytes.as_slice()), most),
            Self::Zlib => inflated(ZlibDecoder::new(bytes.as_slice()), most),
            Self::Blosc => blosc::unpack(&bytes, most),
            Self::Checksum => {
                let length = bytes.len().checked_sub(4).ok_or("a chunk is cut")?;
                Ok(bytes[..length].to_vec())
            }
            Self::Shards { inner, index_bytes, is_index_first } => {
                inner.of_shard(&bytes, *index_bytes, *is_index_first)
            }
        }
    }
}

/// A name and a table of settings of metadata.
pub(super) fn name_of(value: &Value) -> &str {
    value.get("name").or(value.get("id")).and_then(Value::as_str).or(value.as_str()).unwrap_or_default()
}

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
