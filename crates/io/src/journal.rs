//! Lines written one after another by a long run of many parts, which can be taken up again where it was cut off.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, OutputFault};
use crate::output::{OutputDirectory, output_error};
use crate::recording::{FOLDER, remove};

const NAME: &str = "journal";

/// The lines of an unfinished run inside its output directory. The first says what the run is, each other one a part of it
/// that is done, in any order.
///
/// A line is on the disk when [`append`](Self::append) returns. One that was cut off, so that it lacks its end, counts as not
/// written.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let out = folder.path().join("out");
/// use voronudge_io::Journal;
/// let mut journal = Journal::begin(&out, "squares of 1 to 3")?;
/// journal.append("2 4")?;
/// drop(journal); // the program dies, while it writes
/// let torn = out.join(".voronudge-run/journal");
/// std::fs::write(&torn, std::fs::read_to_string(&torn)? + "3 ")?;
///
/// let (mut journal, lines) = Journal::resume(&out)?;
/// assert_eq!(lines, ["squares of 1 to 3", "2 4"]);
/// journal.append("1 1")?;
/// assert_eq!(Journal::find(&out)?.map(|lines| lines.len()), Some(3));
/// journal.discard()?;
/// assert_eq!(Journal::find(&out)?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    path: PathBuf,
    file: File,
    /// The output directory, if it was made here.
    made: Option<PathBuf>,
}

impl Journal {
    /// Begins a journal in an output directory, which is made if need be. An unfinished run is given up.
    ///
    /// # Errors
    /// [`Error::Output`] where a file cannot be written.
    pub fn begin(out: &Path, first: &str) -> Result<Self, Error> {
        if out.as_os_str().is_empty() {
            return Err(output_error(out, OutputFault::Unnamed));
        }
        if out.is_file() {
            return Err(output_error(out, OutputFault::NotADirectory));
        }
        let made = (!out.exists()).then(|| out.to_path_buf());
        fs::create_dir_all(out).map_err(|source| output_error(out, OutputFault::Create(source)))?;
        let folder = out.join(FOLDER);
        remove(&folder)?;
        fs::create_dir(&folder).map_err(|source| output_error(&folder, OutputFault::NotWritable(source)))?;
        let path = folder.join(NAME);
        let file =
            File::create(&path).map_err(|source| output_error(&path, OutputFault::NotWritable(source)))?;
        let mut journal = Self { folder, path, file, made };
        journal.append(first)?;
        Ok(journal)
    }

    /// The whole lines of an unfinished run in an output directory; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be read.
    pub fn find(out: &Path) -> Result<Option<Vec<String>>, Error> {
        let path = out.join(FOLDER).join(NAME);
        match fs::read(&path) {
            Ok(bytes) => {
                let lines = whole_lines(&bytes);
                Ok((!lines.is_empty()).then_some(lines))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(output_error(&path, OutputFault::Write(source))),
        }
    }

    /// Takes up an unfinished journal after its last whole line; also returns the lines so far.
    ///
    /// # Errors
    /// [`Error::Output`] where there is none, or it cannot be written.
    pub fn resume(out: &Path) -> Result<(Self, Vec<String>), Error> {
        let folder = out.join(FOLDER);
        let path = folder.join(NAME);
        let open = || {
            let bytes = fs::read(&path)?;
            let mut file = OpenOptions::new().write(true).open(&path)?;
            file.set_len(whole(&bytes).len() as u64)?;
            file.seek(SeekFrom::End(0))?;
            Ok((file, whole_lines(&bytes)))
        };
        let (file, lines) = open().map_err(|source| output_error(&path, OutputFault::Write(source)))?;
        Ok((Self { folder, path, file, made: None }, lines))
    }

    /// Appends a line, without its end, which must not have another inside.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be written.
    pub fn append(&mut self, line: &str) -> Result<(), Error> {
        let write = |file: &mut File| {
            file.write_all(format!("{line}\n").as_bytes())?;
            file.sync_data()
        };
        write(&mut self.file).map_err(|source| output_error(&self.path, OutputFault::Write(source)))
    }

    /// The results of the output directory. The journal stays until [`discard`](Self::discard).
    ///
    /// # Errors
    /// [`Error::Output`] where the directory cannot be written to.
    pub fn results(&self) -> Result<OutputDirectory, Error> {
        OutputDirectory::staged_in(self.folder.parent().unwrap_or(&self.folder), &self.folder)
    }

    /// Removes the journal, once the results are in place; and the output directory if it was made for it and is empty.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be removed.
    pub fn discard(self) -> Result<(), Error> {
        remove(&self.folder)?;
        if let Some(out) = &self.made {
            // Fails, as it should, where the directory holds results.
            let _ = fs::remove_dir(out);
        }
        Ok(())
    }
}

/// What comes up to and including the last end of a line.
fn whole(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    &bytes[..end]
}

fn whole_lines(bytes: &[u8]) -> Vec<String> {
    String::from_utf8_lossy(whole(bytes)).lines().map(str::to_owned).collect()
}
