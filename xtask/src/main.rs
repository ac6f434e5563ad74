//! Automation of this repository: `cargo xtask <command>`.

mod bench;
mod book;
mod check;
mod fields;
mod figures;
mod fixtures;
mod fuzz;
mod oracle;
mod peers;
mod program;
mod quotes;
mod soak;
mod study;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Automation of this repository.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Time hot formulas against the number of cells and of threads, with memory, and compare with the record.
    Bench(bench::Arguments),
    /// Make the pages into a site with search, in target/book; needs mdBook.
    Book,
    /// Run the checks that every change must pass, in order, and stop at the first failure.
    Check {
        /// Run these only.
        #[arg(long, value_delimiter = ',', value_enum)]
        only: Vec<check::Check>,
    },
    /// Write the tables of the fields of reports into the pages, from the types.
    Fields,
    /// Make figures of the paper anew, and the page of them.
    Figures(figures::Arguments),
    /// Feed readers of files with inputs that are changed by a fuzzer.
    Fuzz(fuzz::Arguments),
    /// Compare the program with what else one might use on the same movies, and print tables.
    Peers(peers::Arguments),
    /// Run again what pages quote, and compare: consoles, and the numbers of docs/quotes.toml.
    Quotes(quotes::Arguments),
    /// Kill runs of the program at random moments, take them up again, and compare with runs that were left alone.
    Soak(soak::Arguments),
    /// Run a statistical study and print its table.
    Study(Box<study::Arguments>),
    /// Make everything in fixtures/ from recorded seeds; twice gives the same bytes.
    Fixtures {
        /// Folder to write to.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
}

/// What a command came to; failures of any kind are for a person to read.
type Outcome = Result<(), Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let root = root();
    let outcome = match Arguments::parse().command {
        Command::Bench(arguments) => bench::run(&root, &arguments),
        Command::Book => book::run(&root),
        Command::Check { only } => check::run(&root, &only),
        Command::Fields => fields::run(&root),
        Command::Figures(arguments) => figures::run(&root, &arguments),
        Command::Fuzz(arguments) => fuzz::run(&root, &arguments),
        Command::Peers(arguments) => peers::run(&root, &arguments),
        Command::Quotes(arguments) => quotes::run(&root, &arguments),
        Command::Soak(arguments) => soak::run(&root, &arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Fixtures { out } => fixtures::make(&out.unwrap_or_else(|| root.join("fixtures"))),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the workspace.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
