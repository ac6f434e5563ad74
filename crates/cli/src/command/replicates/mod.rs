//! Fits to synthetic data that are kept: a run that was cut off goes on, and machines share them. These are the null sets of `discover` and the
//! bootstrap of `infer`.
//!
//! | file | what |
//! |---|---|
//! | `header` | what a run was asked for, and in what another differs |
//! | `lines` | what the fits came to, as lines of a journal or of a part |
//! | `kept` | the journal of a run, and the part that it writes |

mod header;
mod kept;
mod lines;

pub(crate) use header::CommandLine;
pub(crate) use kept::Kept;
pub(crate) use lines::{Agreement, FILE, Made};

use crate::arguments::Shard;
use clap::Args;

#[derive(Debug, Default, Args)]
#[command(next_help_heading = "General")]
pub(crate) struct ReplicateArguments {
    /// Continue the interrupted run in --out, or start one if there is none. A part that is complete is not computed
    /// again.
    #[arg(long)]
    pub resume: bool,
    /// Fit only one part of the synthetic data, such as 1/4, and compute nothing that comes after it; `merge`
    /// combines all parts.
    #[arg(long, value_name = "PART/OF")]
    pub shard: Option<Shard>,
    /// The parts that `merge` puts together.
    #[arg(skip)]
    pub parts: Option<Parts>,
}

/// Parts that were made elsewhere: their command line, which is followed, and their fits to synthetic data.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    pub line: CommandLine,
    pub made: Made,
}
