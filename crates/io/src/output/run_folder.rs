//! The folder of a run at work.

use std::fs;
use std::path::{Path, PathBuf};

use super::run::{RUN, is_empty, remove};
use super::{OutputFolder, output_error};
use crate::error::{Error, OutputFault};

/// The folder of a run at work. It goes with the run if nothing in it can be taken up.
#[derive(Debug)]
pub(crate) struct RunFolder {
    path: PathBuf,
    folder: OutputFolder,
}

impl RunFolder {
    /// Makes an empty one; an unfinished run is given up.
    pub fn begin(folder: &OutputFolder) -> Result<Self, Error> {
        let path = folder.path().join(RUN);
        remove(&path)?;
        fs::create_dir(&path)
            .map_err(|source| output_error(folder.path(), OutputFault::NotWritable(source)))?;
        Ok(Self { path, folder: folder.clone() })
    }

    /// The one that is there.
    pub fn resume(folder: &OutputFolder) -> Self {
        Self { path: folder.path().join(RUN), folder: folder.clone() }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn folder(&self) -> &OutputFolder {
        &self.folder
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if is_empty(&self.path) {
            let _ = remove(&self.path);
        }
    }
}
