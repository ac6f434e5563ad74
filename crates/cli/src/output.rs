//! The folder that results go to, and what must not be lost there.

use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::rehearsal;
use serde_json::Value;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use voronudge_io::{OutputDirectory, OutputFolder};

/// Files of a data set.
const DATA_SET: [&str; 8] = [
    "positions.npy",
    "velocities.npy",
    "flow.npy",
    "flow_x.npy",
    "flow_y.npy",
    "labels.npy",
    "position_errors.npy",
    "dataset.toml",
];

/// No files are read.
pub(crate) const NO_INPUTS: [&Path; 0] = [];

impl CommonArguments {
    /// The output folder of a command that cannot do without, for a run that reads these files.
    pub fn output<P: AsRef<Path>>(
        &self,
        inputs: impl IntoIterator<Item = P>,
    ) -> Result<OutputDirectory, Failure> {
        Ok(OutputDirectory::of(self.claim(inputs)?)?)
    }

    /// The same, for a run that writes files as it goes on. With --dry-run the command ends here, so it comes after all that is quickly
    /// checked and right before the work.
    pub fn claim<P: AsRef<Path>>(
        &self,
        inputs: impl IntoIterator<Item = P>,
    ) -> Result<OutputFolder, Failure> {
        let out = self.required_out()?;
        let inputs: Vec<P> = inputs.into_iter().collect();
        if let Ok(folder) = out.canonicalize() {
            inputs.iter().try_for_each(|input| refuse_input(&folder, input.as_ref()))?;
        }
        self.rehearse(inputs)?;
        let folder = OutputFolder::claim(out)?;
        if !self.overwrite {
            refuse_measured(out)?;
        }
        Ok(folder)
    }

    /// Claims the output folder before checks that take their time; with --dry-run, only checks it.
    pub fn reserve<P: AsRef<Path>>(
        &self,
        inputs: impl IntoIterator<Item = P>,
    ) -> Result<ReservedOutput<'_>, Failure> {
        let inputs: Vec<PathBuf> = inputs.into_iter().map(|input| input.as_ref().to_owned()).collect();
        let out = match self.dry_run {
            true => self.check_output(&inputs).map(|()| None)?,
            false => Some(self.output(&inputs)?),
        };
        Ok(ReservedOutput { common: self, inputs, out })
    }

    /// Refuses an output folder that [`claim`](Self::claim) would refuse.
    fn check_output<P: AsRef<Path>>(&self, inputs: impl IntoIterator<Item = P>) -> Result<(), Failure> {
        let out = self.required_out()?;
        if let Ok(folder) = out.canonicalize() {
            inputs.into_iter().try_for_each(|input| refuse_input(&folder, input.as_ref()))?;
        }
        OutputFolder::check(out)?;
        if self.overwrite { Ok(()) } else { refuse_measured(out) }
    }

    /// Ends a command with --dry-run, after all checks of its output folder.
    pub fn rehearse<P: AsRef<Path>>(&self, inputs: impl IntoIterator<Item = P>) -> Result<(), Failure> {
        if !self.dry_run {
            return Ok(());
        }
        let inputs: Vec<PathBuf> = inputs.into_iter().map(|input| input.as_ref().to_owned()).collect();
        if self.out.is_some() {
            self.check_output(&inputs)?;
        }
        Err(rehearsal::end(&inputs, self.out.as_deref(), self.format))
    }
}

/// The output folder of a run whose work has not begun.
pub(crate) struct ReservedOutput<'a> {
    common: &'a CommonArguments,
    inputs: Vec<PathBuf>,
    out: Option<OutputDirectory>,
}

impl ReservedOutput<'_> {
    /// After all that is checked before the work: with --dry-run the command ends here.
    pub fn begin(self) -> Result<OutputDirectory, Failure> {
        match self.out {
            Some(out) => Ok(out),
            None => self.common.output(&self.inputs),
        }
    }
}

/// Refuses a folder that a file of this run is read from.
fn refuse_input(folder: &Path, input: &Path) -> Result<(), Failure> {
    let Ok(place) = input.canonicalize() else { return Ok(()) };
    let read_from = if place.is_dir() { Some(place.as_path()) } else { place.parent() };
    if read_from != Some(folder) {
        return Ok(());
    }
    Err(Failure::new(format!(
        "{}: is read by this run, whose results would go to the same folder",
        input.display()
    ))
    .with_hint("give an --out folder of its own"))
}

/// Refuses a folder with a data set that this program did not write there.
fn refuse_measured(out: &Path) -> Result<(), Failure> {
    let mut files = DATA_SET.iter().map(|name| out.join(name)).filter(|file| file.exists()).peekable();
    if files.peek().is_none() {
        return Ok(());
    }
    let read = read_by_the_last_run(out);
    let measured = files.find(|file| read.as_ref().is_none_or(|read| read.contains(file)));
    let Some(file) = measured else { return Ok(()) };
    Err(Failure::new(format!(
        "{}: was not written by this program, whose results would replace it",
        file.display()
    ))
    .with_hint("give another --out, or add --overwrite if the data are not needed"))
}

/// Files in a folder that were read by the run whose report is there; `None` if there is no such report.
fn read_by_the_last_run(out: &Path) -> Option<Vec<PathBuf>> {
    let report: Value = serde_json::from_str(&fs::read_to_string(out.join("report.json")).ok()?).ok()?;
    report.get("command")?.as_str()?;
    let inputs = report.get("inputs")?.as_array()?;
    let own = out.canonicalize().ok()?;
    let inside = |path: &Path| {
        let place = path.canonicalize().ok()?;
        (place.parent() == Some(own.as_path())).then(|| out.join(place.file_name().unwrap_or_default()))
    };
    let paths = inputs.iter().filter_map(|input| input.get("path").and_then(Value::as_str));
    Some(paths.filter_map(|path| inside(Path::new(path))).collect())
}

/// A file of earlier results; `None` if there is none.
pub(crate) fn read_if_there(path: &Path) -> Result<Option<String>, Failure> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Failure::new(format!("{}: {error}", path.display()))
            .with_hint("give another --out, or remove what is there")),
    }
}
