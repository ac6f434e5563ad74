//! What a store says of an array: shape, chunks, type of its numbers, compression.

use serde_json::Value;

use super::Fault;
use super::codec::{Codec, name_of};

/// The most axes of an array.
const MOST_AXES: usize = 8;

/// An array in chunks.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub(super) shape: Vec<usize>,
    pub(super) chunk: Vec<usize>,
    /// The type of its numbers, such as `<u2`.
    pub(super) item: String,
    /// Bytes of a number.
    pub(super) width: usize,
    /// From the numbers of a chunk to its file.
    pub(super) codecs: Vec<Codec>,
    /// What stands before the numbers of a chunk in the name of its file, and between them.
    pub(super) key: [String; 2],
    /// What missing chunks are full of, where it is not zero.
    pub(super) fill: Option<String>,
}

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

    /// Bytes of the numbers of an array or of a chunk.
    pub(super) fn bytes(&self, lengths: &[usize]) -> usize {
        lengths.iter().product::<usize>() * self.width
    }

    /// Chunks along each axis.
    pub(super) fn grid(&self) -> Vec<usize> {
        self.shape.iter().zip(&self.chunk).map(|(all, own)| all.div_ceil(*own)).collect()
    }

    /// The numbers of a chunk from the bytes of its file.
    pub(super) fn decode(&self, bytes: Vec<u8>) -> Result<Vec<u8>, Fault> {
        let most = self.bytes(&self.chunk);
        // Before the last step come the checksum and what is longer compressed than not.
        let own = self
            .codecs
            .iter()
            .rev()
            .try_fold(bytes, |bytes, codec| codec.decode(bytes, most + most / 8 + 1024))?;
        match own.len() == most {
            true => Ok(own),
            false => Err(format!("a chunk has {} bytes, and should have {most}", own.len())),
        }
    }

    /// Puts the numbers of a chunk into those of the array.
    pub(super) fn put(&self, index: &[usize], chunk: &[u8], all: &mut [u8]) {
        let origin: Vec<usize> = index.iter().zip(&self.chunk).map(|(own, length)| own * length).collect();
        let extent: Vec<usize> = (0..origin.len())
            .map(|axis| self.chunk[axis].min(self.shape[axis].saturating_sub(origin[axis])))
            .collect();
        let Some((run, outer)) = extent.split_last() else { return };
        let place =
            |lengths: &[usize], at: &[usize]| lengths.iter().zip(at).fold(0, |all, (own, at)| all * own + at);
        for mut row in 0..outer.iter().product::<usize>() {
            let mut at = vec![0; extent.len()];
            for axis in (0..outer.len()).rev() {
                at[axis] = row % outer[axis];
                row /= outer[axis];
            }
            let from = place(&self.chunk, &at) * self.width;
            at.iter_mut().zip(&origin).for_each(|(own, origin)| *own += origin);
            let to = place(&self.shape, &at) * self.width;
            let length = run * self.width;
            if let (Some(to), Some(from)) = (all.get_mut(to..to + length), chunk.get(from..from + length)) {
                to.copy_from_slice(from);
            }
        }
    }

    /// The indices of all chunks.
    pub(super) fn indices(&self) -> impl Iterator<Item = Vec<usize>> {
        let grid = self.grid();
        (0..grid.iter().product::<usize>()).map(move |mut number| {
            let mut index = vec![0; grid.len()];
            for axis in (0..grid.len()).rev() {
                index[axis] = number % grid[axis];
                number /= grid[axis];
            }
            index
        })
    }

    /// The numbers of a file of several chunks, of which this is the layout.
    pub(super) fn of_shard(
        &self,
        bytes: &[u8],
        index_bytes: usize,
        is_index_first: bool,
    ) -> Result<Vec<u8>, Fault> {
        let cut = || "a file of several chunks is cut".to_owned();
        let start = if is_index_first { 0 } else { bytes.len().checked_sub(index_bytes).ok_or_else(cut)? };
        let list = bytes.get(start..start.saturating_add(index_bytes)).ok_or_else(cut)?;
        let mut all = vec![0; self.bytes(&self.shape)];
        for (index, entry) in self.indices().zip(list.chunks_exact(16)) {
            let word = |at: usize| {
                entry[at..at + 8].iter().rev().fold(0_u64, |all, byte| all << 8 | u64::from(*byte))
            };
            let (from, length) = (word(0), word(8));
            // A chunk that is full of the same number is not there.
            if from == u64::MAX && length == u64::MAX {
                continue;
            }
            let (from, length) = (from as usize, length as usize);
            let own = from.checked_add(length).and_then(|end| bytes.get(from..end)).ok_or_else(cut)?;
            self.put(&index, &self.decode(own.to_vec())?, &mut all);
        }
        Ok(all)
    }
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
