//! Statistical studies: longer than tests, with tables for the documentation.

mod nada;
mod noise;
mod recovery;
mod seeds;

use crate::Outcome;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Which study, and how large.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Which study.
    #[arg(value_enum)]
    which: Study,
    /// Number of seeds.
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Only tissues of this many cells (nada).
    #[arg(long)]
    cells: Option<usize>,
    /// Folder for figures (nada).
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

/// The studies there are.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Study {
    /// Parameters recovered from noisy snapshots of a chiral liquid.
    Recovery,
    /// Naive least squares, first-order descent and the search against noise.
    Nada,
    /// Noise levels estimated from one snapshot.
    Noise,
    /// How often intervals cover.
    Coverage,
}

/// Runs a study.
pub fn run(arguments: &Arguments) -> Outcome {
    match arguments.which {
        Study::Recovery => recovery::run(arguments.seeds),
        Study::Nada => nada::run(arguments.seeds, arguments.cells, arguments.figures.as_deref()),
        Study::Noise => noise::levels(arguments.seeds),
        Study::Coverage => noise::coverage(arguments.seeds),
    }
}
