//! Results put in place by one move, which either happens or not; what comes after it can be done again.
//!
//! ```text
//! files complete and on the disk in a hidden folder
//!   └─ the folder gets the name .voronudge-commit: from here on the results are decided
//!        └─ the run that they end is removed ─> files to their places ─> the folder is removed
//! ```

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::held::deciding;
use super::run::{self, RUN};
use super::{output_error, refuse_folder};
use crate::error::{Error, OutputFault};

/// The hidden folder of results that are decided.
pub(crate) const DECIDED: &str = ".voronudge-commit";
/// A file in it if the results end the run whose checkpoint or journal the directory holds.
const ENDS_RUN: &str = ".ends-run";
/// A file in it with the names of earlier results that go, one on a line.
const WITHDRAWN: &str = ".withdrawn";

/// Whether results end the run of the directory that they go to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ends {
    Nothing,
    TheRun,
}

/// Decides that the files of a hidden folder are the results of a directory, and puts them in place.
pub(crate) fn commit(staging: &Path, folder: &Path, withdrawn: &[String], ends: Ends) -> Result<(), Error> {
    let switch = || {
        if !withdrawn.is_empty() {
            let mut list = File::create(staging.join(WITHDRAWN))?;
            list.write_all(withdrawn.join("\n").as_bytes())?;
            list.sync_all()?;
        }
        if ends == Ends::TheRun {
            File::create(staging.join(ENDS_RUN))?.sync_all()?;
        }
        sync_folder(staging)?;
        fs::rename(staging, folder.join(DECIDED))?;
        sync_folder(folder)
    };
    deciding(|| {
        switch().map_err(|source| output_error(folder, OutputFault::Switch(source)))?;
        complete(folder)
    })
}

/// Puts results that are decided in place; nothing to do if there are none.
pub(crate) fn complete(folder: &Path) -> Result<(), Error> {
    let decided = folder.join(DECIDED);
    let Some(names) = names(&decided).map_err(|source| unfinished(&decided, source, [0, 0]))? else {
        return Ok(());
    };
    if decided.join(ENDS_RUN).exists() {
        run::remove(&folder.join(RUN))?;
    }
    for (done, name) in names.iter().enumerate() {
        let target = folder.join(name);
        refuse_folder(&target)?;
        match fs::rename(decided.join(name), &target) {
            // Moved by another process, where there are no locks.
            Err(error) if error.kind() == io::ErrorKind::NotFound && target.is_file() => {}
            moved => moved.map_err(|source| unfinished(&target, source, [done, names.len()]))?,
        }
    }
    let total = names.len();
    let withdrawn = fs::read_to_string(decided.join(WITHDRAWN)).unwrap_or_default();
    let plain = |name: &&str| Path::new(name).file_name().is_some_and(|plain| plain == *name);
    let withdrawn = withdrawn.lines().filter(plain).map(|name| folder.join(name));
    for target in withdrawn.filter(|target| target.is_file()) {
        fs::remove_file(&target).map_err(|source| unfinished(&target, source, [total, total]))?;
    }
    sync_folder(folder).map_err(|source| unfinished(folder, source, [total, total]))?;
    run::remove(&decided)
}

/// Names of the files in a folder that are results, in order; `None` if there is no such folder.
fn names(folder: &Path) -> io::Result<Option<Vec<OsString>>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        entries => entries?,
    };
    let names = entries.map(|entry| entry.map(|entry| entry.file_name()));
    let mut names: Vec<OsString> = names.collect::<io::Result<_>>()?;
    names.retain(|name| name != ENDS_RUN && name != WITHDRAWN);
    names.sort();
    Ok(Some(names))
}

fn unfinished(path: &Path, source: io::Error, [done, total]: [usize; 2]) -> Error {
    output_error(path, OutputFault::Rename { source, done, total })
}

/// Waits until the names in a folder are on the disk.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder)?.sync_all() {
        // Some file systems cannot, for folders.
        Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => {
            Ok(())
        }
        synced => synced,
    }
}

/// Folders cannot be opened as files here.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// The paths that results of these names have.
pub(crate) fn targets(folder: &Path, names: &[String]) -> Result<Vec<PathBuf>, Error> {
    let targets: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    targets.iter().try_for_each(|target| refuse_folder(target))?;
    Ok(targets)
}
