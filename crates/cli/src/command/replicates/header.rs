//! What a run was asked for.

use crate::arguments::Shard;
use crate::failure::Failure;
use serde::{Deserialize, Serialize};
use std::any::TypeId;
use std::collections::BTreeMap;
use std::path::PathBuf;
use voronudge_io::DataSet;

/// Arguments on which no number depends, or that are compared by themselves.
const INDIFFERENT: [&str; 10] =
    ["out", "dry_run", "overwrite", "seed", "threads", "quiet", "format", "open_report", "resume", "shard"];

/// What stands for a file, whose content is compared.
const FILE_GIVEN: &str = "(file)";

/// The words of a command line, without the name of the program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct CommandLine(Vec<String>);

impl CommandLine {
    /// As it was typed.
    pub fn typed() -> Self {
        Self(crate::command_line::typed().iter().skip(1).cloned().collect())
    }

    /// The words, the name of the program first.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        std::iter::once("voronudge").chain(self.0.iter().map(String::as_str))
    }

    /// The values of all arguments of the command, defaults included, by name.
    fn settings(&self) -> Result<BTreeMap<String, Vec<String>>, Failure> {
        let matches = crate::program::description().try_get_matches_from(self.words())?;
        let whole = crate::program::description();
        let mut settings = BTreeMap::new();
        let Some((name, own)) = matches.subcommand() else { return Ok(settings) };
        let command = whole.find_subcommand(name);
        for argument in command.iter().flat_map(|command| command.get_arguments()) {
            let id = argument.get_id().as_str();
            let values = own.try_get_raw(id).ok().flatten();
            let Some(values) = values.filter(|_| !INDIFFERENT.contains(&id)) else { continue };
            let is_file = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
            let word = |value: &std::ffi::OsStr| match is_file {
                true => FILE_GIVEN.to_owned(),
                false => value.to_string_lossy().into_owned(),
            };
            let name = argument.get_long().map_or_else(|| id.to_owned(), |long| format!("--{long}"));
            settings.insert(name, values.map(word).collect());
        }
        Ok(settings)
    }
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Input {
    path: String,
    sha256: String,
}

/// Everything that the fits of a run depend on: the first line of its journal, or of its part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub command: String,
    version: String,
    pub shard: Shard,
    seed: u64,
    settings: BTreeMap<String, Vec<String>>,
    inputs: Vec<Input>,
    /// As typed, to be followed again by `merge`.
    pub command_line: CommandLine,
}

impl Header {
    pub fn new(
        (command, line): (&str, &CommandLine),
        seed: u64,
        shard: Option<Shard>,
        data: &DataSet,
    ) -> Result<Self, Failure> {
        let inputs = data.inputs.iter();
        let input = |input: &voronudge_io::InputFile| Input {
            path: input.path.display().to_string(),
            sha256: input.sha256.clone(),
        };
        Ok(Self {
            command: command.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            shard: shard.unwrap_or(Shard::WHOLE),
            seed,
            settings: line.settings()?,
            inputs: inputs.map(input).collect(),
            command_line: line.clone(),
        })
    }

    /// The first thing in which another request differs, its part aside.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.command != other.command {
            return Some("command".into());
        }
        if self.version != other.version {
            return Some("version".into());
        }
        if self.seed != other.seed {
            return Some("--seed".into());
        }
        let mut names = self.settings.keys().chain(other.settings.keys());
        if let Some(name) = names.find(|name| self.settings.get(*name) != other.settings.get(*name)) {
            return Some(name.clone());
        }
        let mut inputs = self.inputs.iter().enumerate();
        let differs = |own: &Input, at: usize| other.inputs.get(at).is_none_or(|o| o.sha256 != own.sha256);
        let input = inputs.find(|(at, own)| differs(own, *at)).map(|(_, own)| own);
        input.or_else(|| other.inputs.get(self.inputs.len())).map(|own| own.path.clone())
    }
}
