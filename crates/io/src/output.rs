//! Results written so that a run that dies leaves the earlier results whole.

pub(crate) mod commit;
pub(crate) mod folder;
mod held;
pub(crate) mod run;
pub(crate) mod run_folder;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use ndarray::{ArrayView, Dimension};
use ndarray_npy::WritableElement;
use tempfile::TempDir;

use crate::array::write_npy;
use crate::error::{Error, OutputFault};
use commit::Ends;
pub use folder::OutputFolder;
use run_folder::RunFolder;

/// How names of hidden folders begin.
const STAGING: &str = ".voronudge-";

/// A directory that receives results all at once.
///
/// Files are written completely into a hidden directory inside it. [`commit`](Self::commit) decides by one move that they
/// are the results, and puts them in place; where a process dies after that move, the next to claim or to read the directory
/// finishes. Dropping without a commit removes them, and the directory too if it was made for this run. Files of other names
/// are left alone.
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
    /// The run that it ends, if it has files in common with it.
    _run: Option<RunFolder>,
    ends: Ends,
    folder: OutputFolder,
    /// File names in the order of writing, each once.
    staged: Vec<String>,
    /// Earlier results that go.
    withdrawn: Vec<String>,
}

impl OutputDirectory {
    /// Claims a directory for results.
    ///
    /// # Errors
    /// As [`OutputFolder::claim`].
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, Error> {
        Self::of(OutputFolder::claim(path)?)
    }

    /// For a directory that is claimed.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be written to.
    pub fn of(folder: OutputFolder) -> Result<Self, Error> {
        let staging = hidden(STAGING, folder.path(), folder.path())?;
        Ok(Self {
            staging,
            _run: None,
            ends: Ends::Nothing,
            folder,
            staged: Vec::new(),
            withdrawn: Vec::new(),
        })
    }

    /// For the results of a run, with the files that are not yet in place in its folder.
    pub(crate) fn of_run(run: RunFolder) -> Result<Self, Error> {
        let folder = run.folder().clone();
        let staging = hidden("results-", run.path(), folder.path())?;
        Ok(Self {
            staging,
            _run: Some(run),
            ends: Ends::TheRun,
            folder,
            staged: Vec::new(),
            withdrawn: Vec::new(),
        })
    }

    /// The directory as it is claimed.
    #[must_use]
    pub fn folder(&self) -> &OutputFolder {
        &self.folder
    }

    /// The directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// States that the results end the run whose journal is in the directory: the commit removes it.
    pub fn end_run(&mut self) {
        self.ends = Ends::TheRun;
    }

    /// States that an earlier result of this name does not go with these results: the commit removes it.
    ///
    /// # Errors
    /// [`Error::Output`] where `name` is not a plain file name.
    pub fn withdraw(&mut self, name: &str) -> Result<(), Error> {
        self.check_name(name)?;
        self.withdrawn.push(name.to_owned());
        Ok(())
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

    /// Takes in a finished file of the run, by its name there; it stays there as well.
    pub(crate) fn link(&mut self, name: &str, (path, file): (&Path, &File)) -> Result<(), Error> {
        let target = self.path().join(name);
        refuse_folder(&target)?;
        let staged = self.staging.path().join(name);
        let link = || {
            if fs::hard_link(path, &staged).is_err() {
                fs::copy(path, &staged)?;
                File::open(&staged)?.sync_all()?;
            }
            match folder::is_at(file, path) {
                true => Ok(()),
                false => Err(io::Error::other("another program has replaced it")),
            }
        };
        link().map_err(|source| output_error(&target, OutputFault::Write(source)))?;
        self.staged.retain(|known| known != name);
        self.staged.push(name.to_owned());
        Ok(())
    }

    /// Puts all results in place; earlier results of the same names are replaced.
    ///
    /// Returns the paths of the results in the order of writing.
    ///
    /// # Errors
    /// [`Error::Output`]; whether a name is taken by a folder is looked at before anything is decided.
    pub fn commit(self) -> Result<Vec<PathBuf>, Error> {
        let targets = commit::targets(self.path(), &self.staged)?;
        let withdrawn: Vec<String> =
            self.withdrawn.iter().filter(|name| !self.staged.contains(name)).cloned().collect();
        commit::commit(self.staging.path(), self.path(), &withdrawn, self.ends)?;
        Ok(targets)
    }

    fn write_elements<A: WritableElement, D: Dimension>(
        &mut self,
        name: &str,
        array: ArrayView<'_, A, D>,
    ) -> Result<(), Error> {
        self.stage(name, |file| write_npy(file, array))
    }

    pub(crate) fn stage(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), Error> {
        let target = self.path().join(name);
        self.check_name(name)?;
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

    /// Refuses what would be a place elsewhere.
    fn check_name(&self, name: &str) -> Result<(), Error> {
        match Path::new(name).file_name().is_some_and(|plain| plain == name) {
            true => Ok(()),
            false => Err(output_error(self.path(), OutputFault::InvalidName { name: name.to_owned() })),
        }
    }
}

/// Makes a hidden folder for files that are not yet in place.
fn hidden(prefix: &str, parent: &Path, out: &Path) -> Result<TempDir, Error> {
    let made = tempfile::Builder::new().prefix(prefix).tempdir_in(parent);
    made.map_err(|source| output_error(out, OutputFault::NotWritable(source)))
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
