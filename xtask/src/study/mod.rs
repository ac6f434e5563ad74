//! Statistical studies: longer than tests, with tables for the documentation.

mod recovery;

use crate::Outcome;
use clap::ValueEnum;

/// The studies there are.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Study {
    /// Parameters recovered from noisy snapshots of a chiral liquid.
    Recovery,
}

/// Runs a study.
pub fn run(study: Study, seeds: u64) -> Outcome {
    match study {
        Study::Recovery => recovery::run(seeds),
    }
}
