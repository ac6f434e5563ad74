//! What the crate promises, checked through its public interface.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod arrays;
mod corpus;
mod datasets;
mod flow_arrays;
mod flow_tables;
mod flows;
mod folders;
mod foreign_tables;
mod frames;
mod other_programs;
mod output;
mod settings;
mod trackmate_files;
mod tracks;
mod velocities;

use std::fs;
use std::path::{Path, PathBuf};

use ndarray::{Array, Dimension};
use ndarray_npy::{WritableElement, write_npy};
use tempfile::TempDir;
use voronudge_io::Error;

/// A folder that lives as long as the test.
struct Scratch(TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn root(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).unwrap();
        path
    }

    /// Writes an array with ndarray-npy, which is not what the crate reads with.
    fn write_array<A: WritableElement, D: Dimension>(&self, name: &str, array: &Array<A, D>) -> PathBuf {
        let path = self.path(name);
        write_npy(&path, array).unwrap();
        path
    }
}

/// Names of all files of a folder, hidden ones too, in order.
fn names(path: &Path) -> Vec<String> {
    let entries = fs::read_dir(path).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Asserts that the message names the file and contains every fact, in user style, and that the
/// hint contains the advice.
#[track_caller]
fn assert_told<T: std::fmt::Debug>(result: Result<T, Error>, facts: &[&str], advice: &str) {
    let error = result.expect_err("bad input was accepted");
    let message = error.to_string();
    for fact in facts {
        assert!(message.contains(fact), "\"{fact}\" is not in: {message}");
    }
    assert!(!message.ends_with('.'), "full stop: {message}");
    assert!(!message.contains('\n'), "several lines: {message}");
    let hint = error.hint().unwrap_or_else(|| panic!("no hint for: {message}"));
    assert!(hint.contains(advice), "\"{advice}\" is not in: {hint}");
}
