//! Lines written one after another by a long run of many parts, which can be taken up again where it was cut off.

use std::fs::{self, File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::digest::sha256;
use crate::error::{Error, OutputFault};
use crate::output::run::{self, JOURNAL, RUN, remove};
use crate::output::run_folder::RunFolder;
use crate::output::{OutputDirectory, OutputFolder, output_error};

/// Digits of the checksum before a line.
const DIGITS: usize = 16;

/// The lines of an unfinished run inside its output directory. The first says what the run is, each other one a part of it
/// that is done, in any order.
///
/// A line is on the disk when [`append`](Self::append) returns. One that was cut off, so that it lacks its end, counts as not
/// written. Each has a checksum of itself and its number before it, so that a journal that was changed is refused.
///
/// ```
/// # let scratch = tempfile::tempdir()?;
/// # let out = scratch.path().join("out");
/// use voronudge_io::{Journal, OutputFolder};
/// let folder = OutputFolder::claim(&out)?;
/// let mut journal = Journal::begin(&folder, "squares of 1 to 3")?;
/// journal.append("2 4")?;
/// drop(journal); // the program dies, while it writes
/// let torn = out.join(".voronudge-run/journal");
/// std::fs::write(&torn, std::fs::read_to_string(&torn)? + "3 ")?;
///
/// let (mut journal, lines) = Journal::resume(&folder)?;
/// assert_eq!(lines, ["squares of 1 to 3", "2 4"]);
/// journal.append("1 1")?;
/// assert_eq!(Journal::find(&out)?.map(|lines| lines.len()), Some(3));
/// journal.discard()?;
/// assert_eq!(Journal::find(&out)?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
    /// Lines so far.
    lines: usize,
    /// Whether a line could not be written: what came after it would be numbered as that one.
    broken: bool,
    run: RunFolder,
}

impl Journal {
    /// Begins a journal in an output directory. An unfinished run is given up.
    ///
    /// # Errors
    /// [`Error::Output`] where a file cannot be written.
    pub fn begin(folder: &OutputFolder, first: &str) -> Result<Self, Error> {
        let run = RunFolder::begin(folder)?;
        let path = run.path().join(JOURNAL);
        let file =
            File::create(&path).map_err(|source| output_error(&path, OutputFault::NotWritable(source)))?;
        let mut journal = Self { file, path, lines: 0, broken: false, run };
        journal.append(first)?;
        Ok(journal)
    }

    /// The whole lines of an unfinished run in an output directory; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read, [`Error::Output`] where it was changed.
    pub fn find(out: &Path) -> Result<Option<Vec<String>>, Error> {
        let path = out.join(RUN).join(JOURNAL);
        let Some(bytes) = run::read(&path)? else { return Ok(None) };
        let lines = whole_lines(&path, &bytes)?;
        Ok((!lines.is_empty()).then_some(lines))
    }

    /// Takes up an unfinished journal after its last whole line; also returns the lines so far.
    ///
    /// # Errors
    /// [`Error::Output`] where there is none, it was changed, or it cannot be written.
    pub fn resume(folder: &OutputFolder) -> Result<(Self, Vec<String>), Error> {
        let run = RunFolder::resume(folder);
        let path = run.path().join(JOURNAL);
        let failure = |source| output_error(&path, OutputFault::Write(source));
        let bytes = fs::read(&path).map_err(failure)?;
        let lines = whole_lines(&path, &bytes)?;
        let open = || {
            let mut file = OpenOptions::new().write(true).open(&path)?;
            file.set_len(whole(&bytes).len() as u64)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(failure)?;
        Ok((Self { file, path, lines: lines.len(), broken: false, run }, lines))
    }

    /// Appends a line, without its end, which must not have another inside.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be written.
    pub fn append(&mut self, line: &str) -> Result<(), Error> {
        let text = format!("{} {line}\n", checksum(self.lines, line));
        let write = |file: &mut File| {
            file.write_all(text.as_bytes())?;
            file.sync_data()
        };
        let earlier = || Err(std::io::Error::other("an earlier line could not be written"));
        let written = if self.broken { earlier() } else { write(&mut self.file) };
        self.broken = written.is_err();
        written.map_err(|source| output_error(&self.path, OutputFault::Write(source)))?;
        self.lines += 1;
        Ok(())
    }

    /// The results of the output directory. The journal stays until they are committed.
    ///
    /// # Errors
    /// [`Error::Output`] where the directory cannot be written to.
    pub fn results(self) -> Result<OutputDirectory, Error> {
        OutputDirectory::of_run(self.run)
    }

    /// Gives the run up.
    ///
    /// # Errors
    /// [`Error::Output`] where it cannot be removed.
    pub fn discard(self) -> Result<(), Error> {
        remove(self.run.path())
    }
}

/// What comes up to and including the last end of a line.
fn whole(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    &bytes[..end]
}

fn whole_lines(path: &Path, bytes: &[u8]) -> Result<Vec<String>, Error> {
    let text = String::from_utf8_lossy(whole(bytes));
    let line = |(number, text): (usize, &str)| match text.split_once(' ') {
        Some((sum, line)) if sum == checksum(number, line) => Ok(line.to_owned()),
        _ => {
            let place = format!("line {} is", number + 1);
            Err(output_error(path, OutputFault::Damaged { place }))
        }
    };
    text.split_terminator('\n').enumerate().map(line).collect()
}

/// The sum of a line and its number, so that lines cannot change places either.
fn checksum(number: usize, line: &str) -> String {
    let mut sum = sha256(format!("{number} {line}").as_bytes());
    sum.truncate(DIGITS);
    sum
}
