//! Automation of this repository: `cargo xtask <command>`.

mod book;
mod check;
mod fuzz;
mod size;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::error::Error;
use std::ffi::OsString;
use std::process::ExitCode;
use xtask::{Outcome, research, root};

/// Automation of this repository.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make the pages into a site with search, in target/book; needs mdBook.
    Book,
    /// Run the checks that every change must pass, in order, and stop at the first failure.
    Check {
        /// Run these only.
        #[arg(long, value_delimiter = ',', value_enum)]
        only: Vec<check::Check>,
    },
    /// Feed readers of files with inputs that are changed by a fuzzer.
    Fuzz(fuzz::Arguments),
    /// Count lines and types of the source of every crate, without tests.
    Size(size::Arguments),
}

fn main() -> ExitCode {
    run().unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

fn run() -> Result<ExitCode, Box<dyn Error>> {
    let root = root();
    let words: Vec<OsString> = std::env::args_os().skip(1).collect();
    if research::is_typed(&words) {
        return Ok(research::run(&root, &words)?);
    }
    let arguments = Arguments::from_arg_matches(&listing_all().get_matches());
    match arguments.unwrap_or_else(|error| error.exit()).command {
        Command::Book => book::run(&root)?,
        Command::Check { only } => check::run(&root, &only)?,
        Command::Fuzz(arguments) => fuzz::run(&root, &arguments)?,
        Command::Size(arguments) => size::run(&root, &arguments)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The command line, which names commands of research as well.
fn listing_all() -> clap::Command {
    let others = research::COMMANDS.map(|(name, about)| clap::Command::new(name).about(about));
    Arguments::command().subcommands(others)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_command_line_is_sound() {
        super::listing_all().debug_assert();
    }
}
