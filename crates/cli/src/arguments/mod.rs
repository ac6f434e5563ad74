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
    /// A summary to read.
    Text,
    /// The content of report.json; for an error, an object with `error`, `hint` and `exit_code`.
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
    /// Folder for the results, created if it does not exist. Required, except by check-gradients.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace a data set in --out even if this program did not write it there. Input files are never replaced.
    #[arg(long)]
    pub overwrite: bool,
    /// Also write each figure of report.html as a file, figure-01-….svg and so on, and the numbers in charts as CSV.
    #[arg(long)]
    pub figures: bool,
    /// Read options from a TOML file whose keys are option names. Options on the command line take precedence.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Check the options and input files, say what would be computed and written, and stop.
    #[arg(long)]
    pub dry_run: bool,
    /// Seed of the random numbers. It affects only commands that use random numbers, but every command records it.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,
    /// Number of threads, 1 to 1024. Results do not depend on it [default: all cores].
    #[arg(long, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print no progress, warnings or summary.
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
