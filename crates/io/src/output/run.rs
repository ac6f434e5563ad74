//! The hidden folder of an unfinished run, which a later run can take up.

use std::fs;
use std::io;
use std::path::Path;

use super::output_error;
use crate::error::{Error, FileFault, OutputFault};

/// Its name.
pub(crate) const RUN: &str = ".voronudge-run";
/// What makes it worth to be taken up: a checkpoint, or a journal.
pub(crate) const CHECKPOINT: &str = "checkpoint";
pub(crate) const JOURNAL: &str = "journal";

/// Whether nothing in the folder of a run can be taken up.
pub(crate) fn is_empty(run: &Path) -> bool {
    ![CHECKPOINT, JOURNAL].iter().any(|name| run.join(name).exists())
}

/// Removes a folder and what is in it; nothing to do if there is none.
pub(crate) fn remove(folder: &Path) -> Result<(), Error> {
    match fs::remove_dir_all(folder) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(output_error(folder, OutputFault::Remove(source)))
        }
        _ => Ok(()),
    }
}

/// The content of a file in the folder of a run; `None` if there is none.
pub(crate) fn read(path: &Path) -> Result<Option<Vec<u8>>, Error> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(Error::File { path: path.to_path_buf(), fault: FileFault::Read(source) }),
    }
}
