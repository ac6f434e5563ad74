//! An output directory that one process at a time writes to.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::commit::{self, DECIDED};
use super::held::{Origin, held};
use super::run::{self, RUN};
use super::{STAGING, output_error};
use crate::error::{Error, OutputFault};

/// The file that is locked. It says who holds the lock, and goes with it.
const LOCK: &str = ".voronudge-lock";
/// Longest text about a holder, in bytes.
const LONGEST_HOLDER: u64 = 300;

/// An output directory, locked for this process.
///
/// The lock is that of the operating system on a hidden file, so it ends with the process however that ends. Whoever takes it
/// first finishes what an earlier process has decided but not finished, and removes what one has left behind. Where the
/// file system knows no locks, there is none.
///
/// Copies stand for the same lock; it is given up when the last is gone. A directory that was made for it goes, too, if it is
/// still empty.
///
/// ```
/// # let scratch = tempfile::tempdir()?;
/// # let path = scratch.path().join("out");
/// use voronudge_io::OutputFolder;
/// let folder = OutputFolder::claim(&path)?;
/// let error = OutputFolder::claim(&path).unwrap_err();
/// assert!(error.to_string().contains("is written to by process"));
/// drop(folder);
/// OutputFolder::claim(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct OutputFolder(Arc<Claim>);

#[derive(Debug)]
struct Claim {
    path: PathBuf,
    origin: Origin,
    lock: Option<File>,
}

impl OutputFolder {
    /// Makes the directory where it does not exist, makes sure that files can be written, and locks it.
    ///
    /// Call it before the computation, so that a hopeless `--out` is told at once.
    ///
    /// # Errors
    /// [`Error::Output`] where the path is a file, cannot be created or written to, or another process holds the lock.
    pub fn claim(path: impl Into<PathBuf>) -> Result<Self, Error> {
        let path = path.into();
        let failure = |fault| Err(output_error(&path, fault));
        if path.as_os_str().is_empty() {
            return failure(OutputFault::Unnamed);
        }
        // No signal ends the process between making the directory and knowing of it.
        let mut held = held();
        let origin = match fs::metadata(&path) {
            Ok(metadata) if metadata.is_dir() => Origin::Found,
            Ok(_) => return failure(OutputFault::NotADirectory),
            Err(_) => match fs::create_dir_all(&path) {
                Ok(()) => Origin::Made,
                Err(source) => return failure(OutputFault::Create(source)),
            },
        };
        let locked = lock(&path);
        if locked.is_ok() {
            held.claims.push((path.clone(), origin));
        }
        drop(held);
        let mut claim = Claim { path, origin, lock: None };
        claim.lock = locked.map_err(|fault| output_error(&claim.path, fault))?;
        commit::complete(&claim.path)?;
        if claim.lock.is_some() {
            sweep(&claim.path)?;
        }
        Ok(Self(Arc::new(claim)))
    }

    /// Whether [`claim`](Self::claim) would succeed, as far as can be told without leaving anything behind.
    ///
    /// # Errors
    /// As [`claim`](Self::claim).
    pub fn check(path: &Path) -> Result<(), Error> {
        let failure = |fault| output_error(path, fault);
        if path.as_os_str().is_empty() {
            return Err(failure(OutputFault::Unnamed));
        }
        let found = fs::metadata(path);
        if found.as_ref().is_ok_and(|found| !found.is_dir()) {
            return Err(failure(OutputFault::NotADirectory));
        }
        // The name of the current directory is empty among ancestors.
        let mut parents =
            path.ancestors().map(|own| if own.as_os_str().is_empty() { Path::new(".") } else { own });
        let parent = parents.find(|own| own.exists()).unwrap_or(Path::new("."));
        tempfile::tempfile_in(parent).map_err(|source| {
            failure(if found.is_ok() {
                OutputFault::NotWritable(source)
            } else {
                OutputFault::Create(source)
            })
        })?;
        match File::open(path.join(LOCK)) {
            Ok(mut file) => match file.try_lock_shared() {
                Err(TryLockError::WouldBlock) => {
                    Err(failure(OutputFault::InUse { holder: holder(&mut file) }))
                }
                _ => Ok(()),
            },
            Err(_) => Ok(()),
        }
    }

    /// The directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Removes what is not yet decided from all directories that this process holds, before it ends at once. Whether it may end: it must
    /// not if results are decided, as they are about to be in place. If it may, nothing can be decided any more.
    #[must_use]
    pub fn abandon_all() -> bool {
        let held = held();
        if held.decided {
            return false;
        }
        for (path, origin) in &held.claims {
            // Whatever stays is swept by the next to claim the directory.
            let _ = sweep(path);
            give_up(path, *origin);
        }
        std::mem::forget(held);
        true
    }

    /// Finishes what a process that ended has decided to put into a directory, if there is such a thing, before the directory is read.
    ///
    /// # Errors
    /// As [`claim`](Self::claim).
    pub fn settle(path: &Path) -> Result<(), Error> {
        if path.join(DECIDED).is_dir() { Self::claim(path).map(|_| ()) } else { Ok(()) }
    }
}

/// Removes what processes that were killed have left in a directory and nobody can use.
fn sweep(path: &Path) -> Result<(), Error> {
    let failure = |source| output_error(path, OutputFault::NotWritable(source));
    for entry in fs::read_dir(path).map_err(failure)? {
        let entry = entry.map_err(failure)?;
        let name = entry.file_name();
        let is_folder = entry.file_type().map_err(failure)?.is_dir();
        let staged = name.to_string_lossy().starts_with(STAGING) && name != RUN && name != DECIDED;
        if is_folder && (staged || (name == RUN && run::is_empty(&entry.path()))) {
            run::remove(&entry.path())?;
        }
    }
    Ok(())
}

/// Removes the file of the lock, and a directory that was made and holds nothing.
fn give_up(path: &Path, origin: Origin) {
    let _ = fs::remove_file(path.join(LOCK));
    if origin == Origin::Made {
        // Fails, as it should, where the directory holds results.
        let _ = fs::remove_dir(path);
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let claim = (self.path.clone(), self.origin);
        held().claims.retain(|other| *other != claim);
        match self.lock {
            // While it is still locked, so that nobody else's file is removed.
            Some(_) => give_up(&self.path, self.origin),
            None if self.origin == Origin::Made => drop(fs::remove_dir(&self.path)),
            None => {}
        }
    }
}

/// Takes the lock of a directory; `None` where locks are not known.
fn lock(folder: &Path) -> Result<Option<File>, OutputFault> {
    let path = folder.join(LOCK);
    loop {
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(OutputFault::NotWritable)?;
        match file.try_lock() {
            Ok(()) if is_at(&file, &path) => {
                file.set_len(0)
                    .and_then(|()| file.write_all(own_name().as_bytes()))
                    .map_err(OutputFault::NotWritable)?;
                return Ok(Some(file));
            }
            // Its holder has removed it in the meantime.
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(OutputFault::InUse { holder: holder(&mut file) }),
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                let _ = fs::remove_file(&path);
                return Ok(None);
            }
            Err(TryLockError::Error(error)) => return Err(OutputFault::NotWritable(error)),
        }
    }
}

/// Whether an open file is still the one of a name.
#[cfg(unix)]
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |metadata: io::Result<fs::Metadata>| metadata.ok().map(|found| (found.dev(), found.ino()));
    let own = place(file.metadata());
    own.is_some() && own == place(fs::metadata(path))
}

/// Open files keep their names where they cannot be removed.
#[cfg(not(unix))]
pub(crate) fn is_at(_: &File, _: &Path) -> bool {
    true
}

/// This process, for others to read.
fn own_name() -> String {
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    format!("process {} ({})", std::process::id(), words.join(" "))
}

/// Who says to hold the lock.
fn holder(file: &mut File) -> String {
    let mut bytes = Vec::new();
    let read = file.take(LONGEST_HOLDER).read_to_end(&mut bytes);
    let text = String::from_utf8_lossy(&bytes).replace(char::is_control, " ");
    match read {
        Ok(_) if !text.trim().is_empty() => text,
        _ => "another process".into(),
    }
}
