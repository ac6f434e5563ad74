//! What automation shares with the package `research`: the commands that are handed on to that, the pages, the folder of the workspace.

pub mod pages;
pub mod research;

use std::path::{Path, PathBuf};

/// What a command came to; failures of any kind are for a person to read.
pub type Outcome = Result<(), Box<dyn std::error::Error>>;

/// The folder of the workspace.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
