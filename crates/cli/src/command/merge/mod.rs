//! `voronudge merge`: the parts of a run put together.

mod diagram;
mod replicates;

use super::phase_diagram::ScalingArguments;
use super::replicates::FILE;
use crate::arguments::{CommonArguments, Shard};
use crate::failure::Failure;
use crate::reporting::{Answer, Command, Described};
use clap::Args;
use diagram::Diagram;
use std::path::{Path, PathBuf};

/// Combines the parts of a run of phase-diagram, discover or infer that were made with --shard.
///
/// The result is that of the run without --shard, byte for byte, except for the record of the run in report.json and
/// on the page. For discover and infer, the data must be where the command line of the parts expects them.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output folders of all parts, in any order.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    scaling: ScalingArguments,
    #[command(flatten)]
    common: CommonArguments,
}

impl Command for Arguments {
    fn run(self) -> Result<Answer, Failure> {
        if self.parts.iter().any(|folder| folder.join(FILE).is_file()) {
            return replicates::run(self);
        }
        Diagram(self).run()
    }

    fn described() -> Vec<Described> {
        Diagram::described()
    }
}

/// What to do about parts that do not belong together.
const HINT: &str = "merge the parts 1/n to n/n of one run, each once";

/// The lines of a part.
fn read(folder: &Path, name: &str) -> Result<String, Failure> {
    voronudge_io::OutputFolder::settle(folder)?;
    let path = folder.join(name);
    std::fs::read_to_string(&path).map_err(|error| {
        let failure = Failure::new(format!("{}: {error}", path.display()));
        match voronudge_io::Journal::find(folder) {
            Ok(Some(_)) => failure.with_hint("this part was interrupted: finish it with --resume"),
            _ => {
                failure.with_hint("give the output folders of phase-diagram, discover or infer with --shard")
            }
        }
    })
}

/// Refuses a part in which something else is said than in the first.
fn refuse_other(first: &Path, folder: &Path, name: &str) -> Failure {
    let [first, folder] = [first, folder].map(Path::display);
    Failure::new(format!("{first} and {folder} are parts of different runs: they have another \"{name}\""))
        .with_hint(HINT)
}

/// Refuses a part in which other tasks were done than it has.
fn refuse_incomplete(folder: &Path, shard: Shard, [done, asked]: [usize; 2]) -> Failure {
    Failure::new(format!("{} has {done} runs, but {shard} has {asked} others", folder.display()))
        .with_hint("make this part again")
}

/// Whether each part is there once.
fn check(parts: &[(&Path, Shard)]) -> Result<(), Failure> {
    let Some(&(first, Shard { of, .. })) = parts.first() else {
        return Err(Failure::new("no parts are given").with_hint(HINT));
    };
    let mut found: Vec<Option<&Path>> = vec![None; of];
    for &(folder, shard) in parts {
        if shard.of != of {
            let text = format!("{} is {shard}, but {} is one of {of}", folder.display(), first.display());
            return Err(Failure::new(text).with_hint(HINT));
        }
        if let Some(other) = found[shard.part - 1].replace(folder) {
            let text = format!("{} and {} are both {shard}", other.display(), folder.display());
            return Err(Failure::new(text).with_hint(HINT));
        }
    }
    match found.iter().position(Option::is_none) {
        Some(missing) => {
            let missing = Shard { part: missing + 1, of };
            Err(Failure::new(format!("{missing} is missing")).with_hint(HINT))
        }
        None => Ok(()),
    }
}
