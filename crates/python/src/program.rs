//! The program, and what its commands take.

use pyo3::prelude::*;
use std::ffi::OsString;

/// An option or an argument of a command.
type Entry = (String, bool, Vec<String>, bool, String);

/// Runs the program with these arguments, the first of which is its name, and returns its exit code.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| voronudge::program::run(arguments))
}

/// All commands with their help: for each the names of its words, what it does, and its options as (name, whether it is given by
/// place, names of its values, whether it may be repeated, help).
#[pyfunction]
pub(crate) fn options() -> Vec<(Vec<String>, String, Vec<Entry>)> {
    let mut found = Vec::new();
    let program = voronudge::program::description();
    let mut open: Vec<(Vec<String>, clap::Command)> =
        program.get_subcommands().map(|own| (vec![own.get_name().to_owned()], own.clone())).collect();
    while let Some((words, command)) = open.pop() {
        let below: Vec<_> =
            command.get_subcommands().filter(|own| own.get_name() != "help").cloned().collect();
        if below.is_empty() {
            let help = command.get_long_about().or(command.get_about()).map(ToString::to_string);
            let entries = command.get_arguments().map(|argument| {
                let name = argument.get_long().map_or_else(|| argument.get_id().to_string(), str::to_owned);
                let takes = argument.get_action().takes_values();
                let values = argument
                    .get_value_names()
                    .map_or_else(Vec::new, |names| names.iter().map(ToString::to_string).collect());
                let repeated = matches!(argument.get_action(), clap::ArgAction::Append);
                let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
                (name, argument.is_positional(), if takes { values } else { Vec::new() }, repeated, help)
            });
            found.push((words.clone(), help.unwrap_or_default(), entries.collect()));
        }
        for own in below {
            let words = words.iter().cloned().chain([own.get_name().to_owned()]).collect();
            open.push((words, own));
        }
    }
    found.sort();
    found
}
