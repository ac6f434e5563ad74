//! Commands of the package `research`, which is compiled only when one of them is typed.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Their names, and what they do.
pub const COMMANDS: [(&str, &str); 8] = [
    (
        "bench",
        "Time hot formulas against the number of cells and of threads, with memory, and compare with the record",
    ),
    ("fields", "Write the tables of the fields of reports into the pages, from the types"),
    ("figures", "Make figures of the paper anew, and the page of them"),
    ("fixtures", "Make everything in fixtures/ from recorded seeds; twice gives the same bytes"),
    ("peers", "Compare the program with what else one might use on the same movies, and print tables"),
    ("quotes", "Run again what pages quote, and compare: consoles, and the numbers of docs/quotes.toml"),
    (
        "soak",
        "Kill runs of the program at random moments, take them up again, and compare with runs that were left alone",
    ),
    ("study", "Run a statistical study and print its table"),
];

/// Whether one of them is typed, or help about one.
pub fn is_typed(words: &[OsString]) -> bool {
    let named = words.iter().find(|word| *word != "help");
    named.is_some_and(|word| COMMANDS.iter().any(|(name, _)| word == name))
}

/// Builds the package and hands the words on to it, where they were typed; the exit code is its own.
///
/// # Errors
///
/// If cargo cannot be run.
pub fn run(root: &Path, words: &[OsString]) -> io::Result<ExitCode> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["run", "--quiet", "--release", "--package", "research", "--manifest-path"]);
    cargo.arg(root.join("Cargo.toml")).arg("--").args(words);
    end_as(&mut cargo)
}

/// Another program in the place of this one, so that whoever ends this one ends that.
#[cfg(unix)]
fn end_as(program: &mut Command) -> io::Result<ExitCode> {
    Err(std::os::unix::process::CommandExt::exec(program))
}

#[cfg(not(unix))]
fn end_as(program: &mut Command) -> io::Result<ExitCode> {
    let code = program.status()?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_commands_are_told_from_those_of_automation() {
        let is_typed = |line: &str| is_typed(&line.split(' ').map(OsString::from).collect::<Vec<_>>());
        for line in ["study noise --seeds 2", "figures --help", "help fixtures"] {
            assert!(is_typed(line), "{line}");
        }
        for line in ["check --only study", "--help", "help", "help check", "studies"] {
            assert!(!is_typed(line), "{line}");
        }
    }
}
