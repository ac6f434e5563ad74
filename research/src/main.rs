//! What is made with the program and its libraries: studies, figures, fixtures, comparisons. `cargo xtask <command>` leads here.

mod bench;
mod fields;
mod figures;
mod fixtures;
mod oracle;
mod peers;
mod program;
mod quotes;
mod soak;
mod study;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;
use xtask::{Outcome, research, root};

/// Under the name of what is typed.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// What each does is said in [`research::COMMANDS`].
#[derive(Subcommand)]
enum Command {
    Bench(bench::Arguments),
    Fields,
    Figures(figures::Arguments),
    Fixtures {
        /// Folder to write to.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    Peers(peers::Arguments),
    Quotes(quotes::Arguments),
    Soak(soak::Arguments),
    Study(Box<study::Arguments>),
}

fn main() -> ExitCode {
    let root = root();
    let arguments = Arguments::from_arg_matches(&described().get_matches());
    let outcome = match arguments.unwrap_or_else(|error| error.exit()).command {
        Command::Bench(arguments) => bench::run(&root, &arguments),
        Command::Fields => fields::run(&root),
        Command::Figures(arguments) => figures::run(&root, &arguments),
        Command::Fixtures { out } => fixtures::make(&out.unwrap_or_else(|| root.join("fixtures"))),
        Command::Peers(arguments) => peers::run(&root, &arguments),
        Command::Quotes(arguments) => quotes::run(&root, &arguments),
        Command::Soak(arguments) => soak::run(&root, &arguments),
        Command::Study(arguments) => study::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The command line, in which each command says what it does.
fn described() -> clap::Command {
    (research::COMMANDS.into_iter()).fold(Arguments::command(), |all, (name, about)| {
        all.mut_subcommand(name, |command| command.about(about))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound_and_all_of_it_is_handed_on() {
        let commands = described();
        assert_eq!(commands.get_subcommands().count(), research::COMMANDS.len());
        commands.debug_assert();
    }
}
