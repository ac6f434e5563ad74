//! `voronudge completions`: what a shell needs to complete commands and options.

use crate::failure::Failure;
use crate::program::{Answer, description};
use crate::terminal;
use clap::Args;
use clap_complete::{Shell, generate};

/// Prints what a shell needs to complete commands, options and their values.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut description(), "voronudge", &mut script);
    terminal::print(&String::from_utf8_lossy(&script)).map_err(|error| {
        Failure::new(format!("stdout: {error}")).with_hint("make room, or print elsewhere")
    })?;
    Ok(Answer::Positive)
}
