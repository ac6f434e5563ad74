//! What a store says of an array: shape, chunks, type of its numbers, compression.

use serde_json::Value;

use super::Fault;
use super::layout::{Codec, Layout};

/// The most axes of an array.
const MOST_AXES: usize = 8;

impl Layout {
    /// From the `.zarray` of version 2.
    pub(super) fn of_version_2(json: &Value) -> Result<Self, Fault> {
        let item = text(json, "dtype")?;
        if json.get("filters").is_some_and(|own| own.as_array().is_some_and(|own| !own.is_empty())) {
            return Err("its numbers are filtered".into());
        }
        let shape = lengths(json.get("shape"))?;
        if json.get("order").and_then(Value::as_str) == Some("F") && shape.len() > 1 {
            return Err("its chunks are in the order of Fortran".into());
        }
        let codecs = match json.get("compressor") {
            None | Some(Value::Null) => Vec::new(),
            Some(own) => vec![Codec::named(name_of(own)).ok_or_else(|| unknown(own))?],
        };
        let separator = json.get("dimension_separator").and_then(Value::as_str).unwrap_or(".");
        Self {
            shape,
            chunk: lengths(json.get("chunks"))?,
            width: width_of(&item)?,
            item,
            codecs,
            key: [String::new(), separator.to_owned()],
            fill: fill(json),
        }
        .checked()
    }

    /// From the `zarr.json` of version 3.
    pub(super) fn of_version_3(json: &Value) -> Result<Self, Fault> {
        let grid = json.pointer("/chunk_grid/configuration/chunk_shape");
        let shape = lengths(json.get("shape"))?;
        let encoding = json.get("chunk_key_encoding");
        let is_default = encoding.is_none_or(|own| name_of(own) == "default");
        let separator = encoding.and_then(|own| own.pointer("/configuration/separator")?.as_str());
        let key = match is_default {
            true => [format!("c{}", separator.unwrap_or("/")), separator.unwrap_or("/").to_owned()],
            false => [String::new(), separator.unwrap_or(".").to_owned()],
        };
        let kind = text(json, "data_type")?;
        let mut layout = Self::of_codecs(&kind, json.get("codecs"), shape, lengths(grid)?)?;
        layout.key = key;
        layout.fill = fill(json);
        layout.checked()
    }

    /// Numbers of a kind such as `uint16` that are made into bytes by codecs.
    fn of_codecs(
        kind: &str,
        codecs: Option<&Value>,
        shape: Vec<usize>,
        chunk: Vec<usize>,
    ) -> Result<Self, Fault> {
        let digits = kind.trim_start_matches(|letter: char| letter.is_ascii_alphabetic());
        let bits: usize = digits.parse().unwrap_or(8);
        let letter = match &kind[..kind.len() - digits.len()] {
            "uint" => "u",
            "int" => "i",
            "float" => "f",
            "bool" => "b",
            _ => return Err(format!("its numbers are of the kind {kind}")),
        };
        let mut order = "<";
        let mut steps = Vec::new();
        for codec in codecs.and_then(Value::as_array).into_iter().flatten() {
            match name_of(codec) {
                "bytes" => {
                    let own = codec.pointer("/configuration/endian").and_then(Value::as_str);
                    order = if own == Some("big") { ">" } else { "<" };
                }
                "sharding_indexed" => {
                    let of = |name: &str| codec.pointer(&format!("/configuration/{name}"));
                    let inner = lengths(of("chunk_shape"))?;
                    let inner = Self::of_codecs(kind, of("codecs"), chunk.clone(), inner)?.checked()?;
                    if chunk.iter().zip(&inner.chunk).any(|(own, part)| own % part != 0) {
                        return Err(format!("chunks of {:?} do not fill files of {chunk:?}", inner.chunk));
                    }
                    let index = of("index_codecs").and_then(Value::as_array).into_iter().flatten();
                    let has_checksum = index.clone().any(|own| name_of(own) == "crc32c");
                    order = if inner.item.starts_with('>') { ">" } else { "<" };
                    let count: usize = inner.grid().iter().product();
                    steps.push(Codec::Shards {
                        index_bytes: count.saturating_mul(16) + if has_checksum { 4 } else { 0 },
                        is_index_first: of("index_location").and_then(Value::as_str) == Some("start"),
                        inner: Box::new(inner),
                    });
                }
                name => steps.push(Codec::named(name).ok_or_else(|| unknown(codec))?),
            }
        }
        let width = bits / 8;
        let order = if width == 1 { "|" } else { order };
        let item = format!("{order}{letter}{width}");
        Ok(Self { shape, chunk, item, width, codecs: steps, key: Default::default(), fill: None })
    }

    /// Refuses what cannot be laid out.
    fn checked(self) -> Result<Self, Fault> {
        let axes = self.shape.len();
        if !(1..=MOST_AXES).contains(&axes) || self.chunk.len() != axes || self.chunk.contains(&0) {
            return Err(format!("chunks of {:?} do not fill an array of {:?}", self.chunk, self.shape));
        }
        if !(1..=8).contains(&self.width) {
            return Err(format!("its numbers are of the type {}", self.item));
        }
        let size = |lengths: &[usize]| lengths.iter().try_fold(self.width, |all, own| all.checked_mul(*own));
        match (size(&self.chunk), size(&self.shape)) {
            (Some(_), Some(_)) => Ok(self),
            _ => Err("it has more numbers than can be counted".into()),
        }
    }
}

impl Codec {
    /// By the name that a store gives it.
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "zstd" | "numcodecs.zstd" => Self::Zstd,
            "gzip" | "numcodecs.gzip" => Self::Gzip,
            "zlib" | "numcodecs.zlib" => Self::Zlib,
            "blosc" | "numcodecs.blosc" => Self::Blosc,
            "crc32c" => Self::Checksum,
            _ => return None,
        })
    }
}

/// A name and a table of settings of metadata.
fn name_of(value: &Value) -> &str {
    value.get("name").or(value.get("id")).and_then(Value::as_str).or(value.as_str()).unwrap_or_default()
}

fn text(json: &Value, key: &str) -> Result<String, Fault> {
    json.get(key)
        .and_then(Value::as_str)
        .map(str::to_owned)
        .ok_or_else(|| format!("it does not say its {key}"))
}

fn lengths(value: Option<&Value>) -> Result<Vec<usize>, Fault> {
    let all = value
        .and_then(Value::as_array)
        .map(|all| all.iter().map(|own| Some(own.as_u64()? as usize)).collect());
    all.flatten().ok_or_else(|| "its shape or its chunks are not stated".into())
}

/// What missing chunks are full of, unless it is zero.
fn fill(json: &Value) -> Option<String> {
    let own = json.get("fill_value")?;
    let is_zero = own.is_null() || own.as_f64() == Some(0.0) || own.as_bool() == Some(false);
    (!is_zero).then(|| own.to_string())
}

/// Bytes of a number of a type such as `<u2`.
fn width_of(item: &str) -> Result<usize, Fault> {
    let digits = item.trim_start_matches(|letter: char| !letter.is_ascii_digit());
    digits
        .parse()
        .ok()
        .filter(|width| (1..=8).contains(width))
        .ok_or_else(|| format!("its numbers are of the type {item}"))
}

fn unknown(codec: &Value) -> Fault {
    format!("its chunks are compressed by {}", crate::error::excerpt(name_of(codec)))
}
