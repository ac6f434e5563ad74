//! Reading whole input files and remembering which ones were read.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::digest::sha256;
use crate::error::{Error, FileFault};
use crate::memory::machine_memory;

/// A file that went into a result, for the record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// The path as given.
    pub path: PathBuf,
    /// SHA-256 of the bytes that were read, 64 lower-case hexadecimal digits.
    pub sha256: String,
}

impl AsRef<Path> for InputFile {
    fn as_ref(&self) -> &Path {
        &self.path
    }
}

/// Reads a regular file and records it.
///
/// The sum is taken of the very bytes handed back, so the record stays true even if the file
/// changes afterwards.
pub(crate) fn read_input(path: &Path) -> Result<(Vec<u8>, InputFile), Error> {
    let bytes = read_bytes(path)?;
    let record = InputFile { path: path.to_path_buf(), sha256: sha256(&bytes) };
    Ok((bytes, record))
}

/// Reads a text file, such as a report of an earlier run, and records it; what is no UTF-8 is replaced.
///
/// # Errors
/// [`Error::File`] if it cannot be read.
pub fn read_text(path: &Path) -> Result<(String, InputFile), Error> {
    let (bytes, record) = read_input(path)?;
    Ok((String::from_utf8_lossy(&bytes).into_owned(), record))
}

/// Reads a regular file: a folder, a pipe or a device is refused, so reading always ends.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    let failure = |fault| Error::File { path: path.to_path_buf(), fault };
    let metadata = fs::metadata(path).map_err(|source| failure(file_fault(source)))?;
    if metadata.is_dir() {
        let detail = || "a file is needed here".to_owned();
        return Err(failure(if is_zarr(path) {
            FileFault::Zarr { detail: detail() }
        } else {
            FileFault::IsFolder
        }));
    }
    if !metadata.is_file() {
        return Err(failure(FileFault::NotRegular));
    }
    // The bytes, and what is made of them.
    let (bytes, limit) = (metadata.len(), machine_memory().map_or(u64::MAX, |memory| memory / 2));
    if bytes > limit {
        return Err(failure(FileFault::BeyondMemory { bytes, limit }));
    }
    fs::read(path).map_err(|source| failure(file_fault(source)))
}

/// Whether a folder is a Zarr store, as OME-Zarr and GEFF are.
pub(crate) fn is_zarr(folder: &Path) -> bool {
    ["zarr.json", ".zgroup", ".zarray"].iter().any(|name| folder.join(name).exists())
}

/// Sorts out the one case of an operating system's refusal that has a name of its own.
pub(crate) fn file_fault(source: std::io::Error) -> FileFault {
    match source.kind() {
        ErrorKind::NotFound => FileFault::Missing,
        _ => FileFault::Read(source),
    }
}
