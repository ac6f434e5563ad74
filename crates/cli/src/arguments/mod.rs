//! Arguments that several commands share.

mod cells;
mod dataset;
mod effects;
mod export;
mod movie;
mod parameters;
mod range;
mod shard;
mod spreads;

pub(crate) use cells::{CellArguments, OfCells, OwnParameters};
pub(crate) use dataset::DataSetArguments;
pub(crate) use effects::{ChosenEffects, EffectArguments, effect, environment};
pub(crate) use export::{ExportArguments, cell_frame};
pub(crate) use movie::MovieArguments;
pub(crate) use parameters::{LARGEST_PARAMETER, ParameterArguments, named};
pub(crate) use range::{Range, positive};
pub(crate) use shard::Shard;
pub(crate) use spreads::{SpreadArguments, Spreads};

use crate::failure::Failure;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Form of what is written to stdout.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// The content of report.json.
    Json,
}

/// How much is said beside the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verbosity {
    Normal,
    Quiet,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct CommonArguments {
    /// Folder for the results; it is made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also replace a data set in --out that this program did not write there. Files that are read are never replaced.
    #[arg(long)]
    pub overwrite: bool,
    /// Options from a file: TOML, whose keys are names of options. One that is typed wins.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Read and check all that would be used, say what would be computed and written, and stop there.
    #[arg(long)]
    pub dry_run: bool,
    /// Seed of random numbers, for commands that draw some; recorded by all.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,
    /// Number of threads (default: all cores). Results do not depend on it.
    #[arg(long, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print neither progress nor a summary.
    #[arg(long)]
    quiet: bool,
    /// What to print on stdout.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
}

impl CommonArguments {
    /// The same with another seed.
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    pub fn verbosity(&self) -> Verbosity {
        if self.quiet { Verbosity::Quiet } else { Verbosity::Normal }
    }

    /// The output folder of a command that cannot do without.
    pub fn required_out(&self) -> Result<&PathBuf, Failure> {
        self.out.as_ref().ok_or_else(|| Failure::new("no output folder is given").with_hint("add --out DIR"))
    }
}
