//! `voronudge completions`: what a shell needs to complete commands and options.

use crate::failure::Failure;
use crate::program::description;
use crate::reporting::{Answer, Command};
use clap::Args;
use clap_complete::{Shell, generate};

/// Prints a script with which a shell completes commands, options and their values.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Shell to print the script for.
    #[arg(value_enum)]
    shell: Shell,
}

impl Command for Arguments {
    fn run(self) -> Result<Answer, Failure> {
        let mut script = Vec::new();
        generate(self.shell, &mut description(), "voronudge", &mut script);
        Answer::printed(&String::from_utf8_lossy(&script))
    }
}
