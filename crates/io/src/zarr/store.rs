//! The files of a store.

use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use super::Fault;
use super::layout::Layout;
use crate::digest::sha256;
use crate::error::{Error, FileFault};
use crate::input::InputFile;
use crate::memory::{SIZE_LIMIT, machine_memory};

/// The most chunks of an array.
const MOST_CHUNKS: usize = 1_000_000;

/// A folder that is read, and the sums of what has been read of it.
pub(super) struct Store {
    root: PathBuf,
    sums: String,
}

/// An array as the bytes of its numbers, the last axis running fastest.
pub(super) struct Numbers {
    pub(super) item: String,
    pub(super) shape: Vec<usize>,
    pub(super) body: Vec<u8>,
}

impl Numbers {
    /// The same as a file of NumPy, in another shape of as many numbers.
    pub(super) fn to_npy(&self, shape: &[usize]) -> Vec<u8> {
        let lengths: Vec<String> = shape.iter().map(|length| format!("{length},")).collect();
        let mut header = format!(
            "{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}",
            self.item,
            lengths.concat()
        );
        let length = (header.len() + 11).next_multiple_of(64) - 10;
        header += &" ".repeat(length - header.len() - 1);
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(&self.body);
        bytes
    }
}

impl Store {
    pub(super) fn new(root: &Path) -> Self {
        Self { root: root.to_path_buf(), sums: String::new() }
    }

    /// The store as an input, by the sums of its files that were read.
    pub(super) fn record(&self) -> InputFile {
        InputFile { path: self.root.clone(), sha256: sha256(self.sums.as_bytes()) }
    }

    /// The fault as one of the store.
    pub(super) fn error(&self, detail: Fault) -> Error {
        Error::File { path: self.root.clone(), fault: FileFault::Zarr { detail } }
    }

    /// What a group or an array says of itself beyond its numbers; nothing if it is not there.
    pub(super) fn attributes(&mut self, place: &str) -> Result<Value, Fault> {
        if let Some(json) = self.json(place, "zarr.json")? {
            return Ok(json.get("attributes").cloned().unwrap_or_default());
        }
        Ok(self.json(place, ".zattrs")?.unwrap_or_default())
    }

    /// Whether there is an array.
    pub(super) fn has_array(&mut self, place: &str) -> Result<bool, Fault> {
        let is_new =
            self.json(place, "zarr.json")?.is_some_and(|json| json.get("node_type") == Some(&"array".into()));
        Ok(is_new || self.json(place, ".zarray")?.is_some())
    }

    /// An array with all its chunks.
    pub(super) fn array(&mut self, place: &str) -> Result<Numbers, Fault> {
        let layout = match (self.json(place, "zarr.json")?, self.json(place, ".zarray")?) {
            (Some(json), _) => Layout::of_version_3(&json)?,
            (None, Some(json)) => Layout::of_version_2(&json)?,
            (None, None) => return Err(format!("it has no array {place}")),
        };
        let bytes = layout.bytes(&layout.shape);
        let limit = machine_memory().map_or(SIZE_LIMIT, |memory| SIZE_LIMIT.min(memory / 4));
        if bytes.max(layout.bytes(&layout.chunk)) as u64 > limit {
            return Err(format!("its array {place} has {bytes} bytes, the limit is {limit}"));
        }
        let chunks: usize = layout.grid().iter().product();
        if chunks > MOST_CHUNKS {
            return Err(format!(
                "its array {place} has {chunks} chunks, more than {MOST_CHUNKS} are not read"
            ));
        }
        let mut body = vec![0; bytes];
        for index in layout.indices() {
            let numbers: Vec<String> = index.iter().map(usize::to_string).collect();
            let [begin, between] = &layout.key;
            let name = format!("{begin}{}", numbers.join(between));
            match (self.read(place, &name)?, &layout.fill) {
                (Some(file), _) => layout.put(&index, &layout.decode(file)?, &mut body),
                (None, None) => {}
                (None, Some(fill)) => {
                    return Err(format!("chunks of {place} are missing that are full of {fill}"));
                }
            }
        }
        Ok(Numbers { item: layout.item, shape: layout.shape, body })
    }

    fn json(&mut self, place: &str, name: &str) -> Result<Option<Value>, Fault> {
        let Some(bytes) = self.read(place, name)? else { return Ok(None) };
        serde_json::from_slice(&bytes)
            .map(Some)
            .map_err(|error| format!("{place}/{name} is no JSON: {error}"))
    }

    /// A file of the store; `None` if it is not there.
    fn read(&mut self, place: &str, name: &str) -> Result<Option<Vec<u8>>, Fault> {
        let path = Path::new(place).join(name);
        if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
            return Err(format!("its part {} leads out of it", crate::error::excerpt(place)));
        }
        let path = self.root.join(path);
        match fs::metadata(&path) {
            Ok(found) if found.is_file() && found.len() <= SIZE_LIMIT => {}
            _ => return Ok(None),
        }
        match fs::read(&path) {
            Ok(bytes) => {
                self.sums += &sha256(&bytes);
                Ok(Some(bytes))
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(format!("{}: {error}", path.display())),
        }
    }
}
