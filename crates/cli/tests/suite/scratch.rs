//! Data sets made for a test, and results read back.

use crate::program::fixture;
use ndarray::{Array, Array2, ArrayD, Dimension};
use ndarray_npy::{ReadableElement, WritableElement, read_npy, write_npy};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder that lives as long as the test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A data set with the files of a fixture.
    pub fn copy_of(name: &str) -> Self {
        let folder = Self::new();
        for entry in fs::read_dir(fixture(name)).unwrap() {
            let entry = entry.unwrap();
            fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
        }
        folder
    }

    /// A data set with these positions and this dataset.toml.
    pub fn data_set<D: Dimension>(positions: &Array<f64, D>, settings: &str) -> Self {
        let folder = Self::new();
        folder.write_array("positions.npy", positions);
        folder.write("dataset.toml", settings);
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.file(name);
        fs::write(&path, content).unwrap();
        path
    }

    pub fn write_array<A: WritableElement, D: Dimension>(&self, name: &str, array: &Array<A, D>) {
        write_npy(self.file(name), array).unwrap();
    }

    /// Changes an array of the shape (cells, 2).
    pub fn change(&self, name: &str, change: impl FnOnce(&mut Array2<f64>)) {
        let mut array: Array2<f64> = read(&self.file(name));
        change(&mut array);
        self.write_array(name, &array);
    }

    pub fn remove(&self, name: &str) {
        fs::remove_file(self.file(name)).unwrap();
    }

    /// Names of all files, hidden ones too, in order.
    pub fn names(&self) -> Vec<String> {
        names(self.path())
    }
}

pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[track_caller]
pub fn read<A: ReadableElement, D: Dimension>(path: &Path) -> Array<A, D> {
    read_npy(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[track_caller]
pub fn report(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("report.json")).unwrap()).unwrap()
}

#[track_caller]
pub fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {pointer}"))
}

/// Asserts that the largest difference is at most `tolerance` of the largest magnitude.
#[track_caller]
pub fn assert_close(found: &ArrayD<f64>, expected: &ArrayD<f64>, tolerance: f64) {
    assert_eq!(found.shape(), expected.shape());
    let largest = |array: &ArrayD<f64>| array.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let error = largest(&(found - expected)) / largest(expected);
    // A NaN is lost by max, so it is looked for by itself.
    assert!(found.iter().all(|value| value.is_finite()) && error <= tolerance, "error {error:e}");
}

/// A version 1 .npy file from the parts of its header, padded the way numpy does.
pub fn npy(descr: &str, order: &str, shape: &str, body: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while !(10 + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(body);
    bytes
}
