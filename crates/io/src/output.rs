//! Results written so that a run that dies leaves the earlier results whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use ndarray::{ArrayView, Dimension};
use ndarray_npy::WritableElement;
use tempfile::TempDir;

use crate::array::write_npy;
use crate::error::{Error, OutputFault};

/// A directory that receives results all at once.
///
/// Files are written completely into a hidden directory inside it and are moved to their places
/// by [`commit`](Self::commit). Dropping without a commit removes them, and the directory too if
/// it was made for this run. Files of other names are left alone.
///
/// ```no_run
/// use ndarray::array;
/// use voronudge_io::OutputDirectory;
/// let mut out = OutputDirectory::create("results")?;
/// out.write_array("areas.npy", array![1.0, 2.0].view())?;
/// out.write_text("report.json", "{}")?;
/// out.commit()?;
/// # Ok::<(), voronudge_io::Error>(())
/// ```
#[derive(Debug)]
pub struct OutputDirectory {
    // Declared, and so dropped, before the directory it lies in.
    staging: TempDir,
    directory: Directory,
    /// File names in the order of writing, each once.
    staged: Vec<String>,
}

/// The directory itself, which goes again if it was made here and stays empty.
#[derive(Debug)]
struct Directory {
    path: PathBuf,
    origin: Origin,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Origin {
    Found,
    Made,
}

impl OutputDirectory {
    /// Makes the directory where it does not exist and makes sure that files can be written.
    ///
    /// Call it before the computation, so that a hopeless `--out` is told at once.
    ///
    /// # Errors
    /// [`Error::Output`] where the path is a file, or cannot be created or written to.
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, Error> {
        let path = path.into();
        let failure = |fault| Err(output_error(&path, fault));
        if path.as_os_str().is_empty() {
            return failure(OutputFault::Unnamed);
        }
        let origin = match fs::metadata(&path) {
            Ok(metadata) if metadata.is_dir() => Origin::Found,
            Ok(_) => return failure(OutputFault::NotADirectory),
            Err(_) => match fs::create_dir_all(&path) {
                Ok(()) => Origin::Made,
                Err(source) => return failure(OutputFault::Create(source)),
            },
        };
        let directory = Directory { path, origin };
        // Making the hidden directory is the proof that the place is writable.
        let staging = tempfile::Builder::new()
            .prefix(".voronudge-")
            .tempdir_in(&directory.path)
            .map_err(|source| output_error(&directory.path, OutputFault::NotWritable(source)))?;
        Ok(Self { staging, directory, staged: Vec::new() })
    }

    /// For a directory that exists, with the files that are not yet in place in a folder of it.
    pub(crate) fn staged_in(path: &Path, folder: &Path) -> Result<Self, Error> {
        let staging = tempfile::Builder::new()
            .prefix("results-")
            .tempdir_in(folder)
            .map_err(|source| output_error(path, OutputFault::NotWritable(source)))?;
        let directory = Directory { path: path.to_path_buf(), origin: Origin::Found };
        Ok(Self { staging, directory, staged: Vec::new() })
    }

    /// The directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.directory.path
    }

    /// The names written so far, in order.
    #[must_use]
    pub fn staged(&self) -> &[String] {
        &self.staged
    }

    /// Writes an array of real numbers as `.npy`, float64.
    ///
    /// # Errors
    /// [`Error::Output`] where `name` is not a plain file name, is taken by a folder, or the
    /// file cannot be written.
    pub fn write_array<D: Dimension>(
        &mut self,
        name: &str,
        array: ArrayView<'_, f64, D>,
    ) -> Result<(), Error> {
        self.write_elements(name, array)
    }

    /// Writes an array of integers as `.npy`, int64.
    ///
    /// # Errors
    /// As [`write_array`](Self::write_array).
    pub fn write_integers<D: Dimension>(
        &mut self,
        name: &str,
        array: ArrayView<'_, i64, D>,
    ) -> Result<(), Error> {
        self.write_elements(name, array)
    }

    /// Writes a text as UTF-8.
    ///
    /// # Errors
    /// As [`write_array`](Self::write_array).
    pub fn write_text(&mut self, name: &str, text: &str) -> Result<(), Error> {
        self.write_bytes(name, text.as_bytes())
    }

    /// Writes bytes as they are.
    ///
    /// # Errors
    /// As [`write_array`](Self::write_array).
    pub fn write_bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        self.stage(name, |file| file.write_all(bytes))
    }

    /// Takes in a finished file that lies elsewhere on the same disk; it stays there as well.
    pub(crate) fn link(&mut self, name: &str, file: &Path) -> Result<(), Error> {
        let target = self.directory.path.join(name);
        refuse_folder(&target)?;
        let staged = self.staging.path().join(name);
        fs::hard_link(file, &staged)
            .or_else(|_| fs::copy(file, &staged).map(|_| ()))
            .map_err(|source| output_error(&target, OutputFault::Write(source)))?;
        self.staged.retain(|known| known != name);
        self.staged.push(name.to_owned());
        Ok(())
    }

    /// Moves everything to its place; earlier results of the same names are replaced.
    ///
    /// Returns the paths of the results in the order of writing.
    ///
    /// # Errors
    /// [`Error::Output`]; whether a name is taken by a folder is looked at before the first move.
    pub fn commit(self) -> Result<Vec<PathBuf>, Error> {
        let names = self.staged.iter();
        let targets: Vec<PathBuf> = names.map(|name| self.directory.path.join(name)).collect();
        for target in &targets {
            refuse_folder(target)?;
        }
        for (done, (name, target)) in self.staged.iter().zip(&targets).enumerate() {
            fs::rename(self.staging.path().join(name), target).map_err(|source| {
                let total = targets.len();
                output_error(target, OutputFault::Rename { source, done, total })
            })?;
        }
        Ok(targets)
    }

    fn write_elements<A: WritableElement, D: Dimension>(
        &mut self,
        name: &str,
        array: ArrayView<'_, A, D>,
    ) -> Result<(), Error> {
        self.stage(name, |file| write_npy(file, array))
    }

    fn stage(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), Error> {
        let target = self.directory.path.join(name);
        let plain = Path::new(name).file_name().is_some_and(|plain| plain == name);
        if !plain {
            let name = name.to_owned();
            return Err(output_error(&self.directory.path, OutputFault::InvalidName { name }));
        }
        refuse_folder(&target)?;
        // A write that fails must not leave half a file to be committed.
        self.staged.retain(|known| known != name);
        let write_file = || {
            let mut writer = BufWriter::new(File::create(self.staging.path().join(name))?);
            write(&mut writer)?;
            writer.flush()?;
            // A full disk may be noticed only here, and here it can still be told.
            writer.get_ref().sync_all()
        };
        write_file().map_err(|source| output_error(&target, OutputFault::Write(source)))?;
        self.staged.push(name.to_owned());
        Ok(())
    }
}

impl Drop for Directory {
    fn drop(&mut self) {
        if self.origin == Origin::Made {
            // Fails, as it should, where the directory holds results.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

fn refuse_folder(target: &Path) -> Result<(), Error> {
    if target.is_dir() {
        return Err(output_error(target, OutputFault::Occupied));
    }
    Ok(())
}

pub(crate) fn output_error(path: &Path, fault: OutputFault) -> Error {
    Error::Output { path: path.to_path_buf(), fault }
}
