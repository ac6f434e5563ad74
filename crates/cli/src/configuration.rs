//! Options from a file: its entries become words of the command line, before those that were typed.

use crate::failure::Failure;
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, Command};
use std::ffi::OsString;
use std::path::PathBuf;
use toml::{Table, Value};

/// The option that names the file.
const OPTION: &str = "--config";

/// Puts the options of the file that --config names in the place of that option. One that was typed, or contradicts one that was
/// typed, is left out. `description` makes the program with its commands.
pub(crate) fn insert(
    words: &mut Vec<OsString>,
    description: impl FnOnce() -> Command,
) -> Result<(), Failure> {
    let Some((file, typed)) = without_option(words) else { return Ok(()) };
    let mut program = description().disable_help_subcommand(true);
    program.build();
    let commands = commands(&program, &typed);
    let Some(command) = commands.last().filter(|own| takes(own, "config")) else { return Ok(()) };
    let place = |text: String| Failure::new(text).at(file.display());
    let (text, _) = voronudge_io::read_text(&file)?;
    let table: Table = text.parse().map_err(|error: toml::de::Error| {
        let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
        let line = line.map(|line| format!("line {line}: ")).unwrap_or_default();
        place(format!("{line}{}", error.message())).with_hint(SYNTAX)
    })?;
    let mut entries: Vec<Entry<'_>> = Vec::new();
    let understood = collect(&commands, &table, &mut entries).and_then(|()| check(command, &entries));
    understood.map_err(|failure| failure.at(file.display()))?;
    let is_typed = |argument: &Arg| typed.iter().any(|word| names(word, argument));
    let contradicts = |argument: &Arg| {
        let against = |one: &Arg, other: &Arg| {
            command.get_arg_conflicts_with(one).iter().any(|own| own.get_id() == other.get_id())
        };
        let mut given = command.get_arguments().filter(|other| is_typed(other));
        given.any(|other| against(argument, other) || against(other, argument))
    };
    entries.retain(|entry| !is_typed(entry.argument) && !contradicts(entry.argument));
    let begin = commands.len();
    *words = typed;
    words.splice(begin..begin, entries.into_iter().flat_map(|entry| entry.words).map(OsString::from));
    Ok(())
}

const SYNTAX: &str =
    "write options as in: position-noise = 0.1, fix = [\"K_A=0.1\"], box = [10, 10], open = true";

/// The file that is named, and the other words; nothing if none is named, or in a way that the parser refuses.
fn without_option(words: &[OsString]) -> Option<(PathBuf, Vec<OsString>)> {
    let end = words.iter().position(|word| word == "--").unwrap_or(words.len());
    let is_option =
        |word: &OsString| word.to_str().is_some_and(|word| word == OPTION || word.starts_with("--config="));
    let mut places = (0..end).filter(|&place| is_option(&words[place]));
    let (place, None) = (places.next()?, places.next()) else { return None };
    let attached = words[place].to_str().and_then(|word| word.strip_prefix("--config="));
    let (file, taken) = match attached {
        Some(file) => (PathBuf::from(file), 1),
        None => (PathBuf::from(words.get(place + 1)?), 2),
    };
    let mut rest = words.to_vec();
    rest.drain(place..place + taken);
    Some((file, rest))
}

/// The program and the commands that the words name, each below the one before it.
fn commands<'a>(program: &'a Command, words: &[OsString]) -> Vec<&'a Command> {
    let mut found = vec![program];
    let mut last = program;
    for word in words.iter().skip(1) {
        let Some(command) = word.to_str().and_then(|word| last.find_subcommand(word)) else { break };
        found.push(command);
        last = command;
    }
    found
}

fn takes(command: &Command, id: &str) -> bool {
    command.get_arguments().any(|own| own.get_id() == id)
}

/// Whether a word is the name of an option, with or without its value.
fn names(word: &OsString, argument: &Arg) -> bool {
    let word = word.to_str().and_then(|word| word.strip_prefix("--"));
    let name = word.map(|word| word.split_once('=').map_or(word, |(name, _)| name));
    name.is_some() && name == argument.get_long()
}

/// An option of the file, and the words that say the same.
struct Entry<'a> {
    argument: &'a Arg,
    words: Vec<String>,
}

/// The options of a table for the last of `commands`, the first of which the table is about. Those in the table of a command win over
/// those above it.
fn collect<'a>(commands: &[&'a Command], table: &Table, entries: &mut Vec<Entry<'a>>) -> Result<(), Failure> {
    let ([above, below @ ..], Some(command)) = (commands, commands.last()) else { return Ok(()) };
    let (tables, options): (Vec<_>, Vec<_>) =
        table.iter().partition(|(key, _)| above.find_subcommand(key).is_some());
    let mut here: Vec<Entry<'a>> = Vec::new();
    for (key, value) in options {
        let argument = option(command, key)?;
        if here.iter().any(|entry| entry.argument.get_id() == argument.get_id()) {
            return Err(Failure::new(format!("{key} is given twice, with - and with _"))
                .with_hint("leave one of them out"));
        }
        here.push(Entry { argument, words: words_of(argument, key, value)? });
    }
    entries.retain(|entry| here.iter().all(|own| own.argument.get_id() != entry.argument.get_id()));
    entries.extend(here);
    for (key, value) in tables {
        let Some(table) = value.as_table() else {
            return Err(Failure::new(format!("{key} is {}, but it is the name of a command", kind(value)))
                .with_hint(format!("write its options below a line [{key}]")));
        };
        if below.first().is_some_and(|own| own.get_name() == key) {
            collect(below, table, entries)?;
        }
    }
    Ok(())
}

/// The option of a command that a key names, with - or _ between words.
fn option<'a>(command: &'a Command, key: &str) -> Result<&'a Arg, Failure> {
    let plain = |name: &str| name.replace('_', "-");
    let found =
        command.get_arguments().find(|own| own.get_long().is_some_and(|name| plain(name) == plain(key)));
    let is_option = |own: &&Arg| {
        let action = own.get_action();
        matches!(action, ArgAction::Set | ArgAction::Append | ArgAction::SetTrue) && own.get_id() != "config"
    };
    found.filter(is_option).ok_or_else(|| {
        let name = command.get_name();
        // The parser knows which one looks like it.
        let similar = command.clone().try_get_matches_from([name.to_owned(), format!("--{key}")]).err();
        let similar = similar.map(Failure::from).and_then(|failure| failure.hint().map(str::to_owned));
        Failure::new(format!("{key} is no option of {name}")).with_hint(
            similar.filter(|hint| hint.contains("similar")).unwrap_or_else(|| {
                format!("options of one command go below a line with its name, [{name}]; --help lists them")
            }),
        )
    })
}

/// The words that say what an entry says.
fn words_of(argument: &Arg, key: &str, value: &Value) -> Result<Vec<String>, Failure> {
    let name = format!("--{}", argument.get_long().unwrap_or_default());
    let refuse = |needed: String| {
        Failure::new(format!("{key} is {}, but {needed} is needed", kind(value))).with_hint(SYNTAX)
    };
    let count = argument.get_num_args().unwrap_or_else(|| 1.into());
    match (argument.get_action(), value) {
        (ArgAction::SetTrue, Value::Boolean(true)) => return Ok(vec![name]),
        (ArgAction::SetTrue, Value::Boolean(false)) => return Ok(Vec::new()),
        (ArgAction::SetTrue, _) => return Err(refuse("true or false".into())),
        (_, Value::Boolean(true)) if count.min_values() == 0 => return Ok(vec![name]),
        _ => {}
    }
    let repeated = matches!(argument.get_action(), ArgAction::Append);
    let listed = match value {
        Value::Array(values) => values.iter().map(text).collect(),
        // NAME=VALUE for each of its entries.
        Value::Table(table) if repeated => {
            table.iter().map(|(key, value)| Some(format!("{key}={}", joined(value)?))).collect()
        }
        single => text(single).map(|single| vec![single]),
    };
    let many = count.max_values() > 1 || repeated;
    let values: Vec<String> = listed.ok_or_else(|| refuse("a text or a number".into()))?;
    match count.min_values() {
        least if least > 1 && values.len() == least => Ok(std::iter::once(name).chain(values).collect()),
        least if least > 1 => Err(refuse(format!("a list of {least} numbers"))),
        _ if argument.get_value_delimiter().is_some() => Ok(vec![format!("{name}={}", values.join(","))]),
        _ if many || values.len() == 1 => Ok(values.iter().map(|value| format!("{name}={value}")).collect()),
        _ => Err(refuse("one value".into())),
    }
}

/// A single value as it would be typed.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Integer(number) => Some(number.to_string()),
        Value::Float(number) => Some(number.to_string()),
        Value::Boolean(_) | Value::Datetime(_) | Value::Array(_) | Value::Table(_) => None,
    }
}

/// One value, or several with commas between.
fn joined(value: &Value) -> Option<String> {
    match value {
        Value::Array(values) => Some(values.iter().map(text).collect::<Option<Vec<_>>>()?.join(",")),
        single => text(single),
    }
}

/// A value in words.
fn kind(value: &Value) -> String {
    match value {
        Value::Array(values) => format!("a list of {}", values.len()),
        Value::Table(_) => "a table".into(),
        single => single.to_string(),
    }
}

/// Refuses values that the command would refuse, and options that contradict each other.
fn check(command: &Command, entries: &[Entry<'_>]) -> Result<(), Failure> {
    let name = std::iter::once(command.get_name().to_owned());
    let words = name.chain(entries.iter().flat_map(|entry| entry.words.iter().cloned()));
    match command.clone().try_get_matches_from(words) {
        // What is missing may have been typed.
        Err(error)
            if !matches!(
                error.kind(),
                ErrorKind::MissingRequiredArgument | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
            ) =>
        {
            Err(error.into())
        }
        _ => Ok(()),
    }
}
