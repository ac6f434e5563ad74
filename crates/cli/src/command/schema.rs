//! `voronudge schema`: what is in a `report.json`, as a JSON Schema.

use crate::failure::Failure;
use crate::program::described;
use crate::reporting::{Answer, Command};
use clap::Args;
use schemars::Schema;
use serde_json::Value;

/// Prints the JSON Schema of the report.json of a command (for info, of what --json prints). Without a name, lists
/// the names of the commands that write one.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The command, such as infer or import tracks.
    #[arg(num_args = 0..=2)]
    command: Vec<String>,
}

/// The schema of what any command writes, for one of them.
fn of_command(name: &str, mut schema: Schema) -> Schema {
    schema.insert("title".into(), format!("report.json of voronudge {name}").into());
    // What has a command line is the record of a run.
    if schema.pointer("/properties/command_line").is_some()
        && let Some(Value::Object(command)) = schema.pointer_mut("/properties/command")
    {
        command.insert("const".into(), name.split(' ').next().into());
    }
    schema
}

impl Command for Arguments {
    fn run(self) -> Result<Answer, Failure> {
        let wanted = self.command.join(" ");
        let described = described();
        let names: Vec<&str> = described.iter().map(|(name, _)| *name).collect();
        let printed = match described.iter().find(|(name, _)| *name == wanted) {
            Some((name, schema)) => serde_json::to_string_pretty(&of_command(name, schema()))?,
            None if wanted.is_empty() => names.join("\n"),
            None => {
                return Err(Failure::new(format!("{wanted}: no command of this name writes a report.json"))
                    .with_hint(format!("there are {}", names.join(", "))));
            }
        };
        Answer::printed(&format!("{printed}\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::description;

    /// The commands that write a report: those whose results can be printed as JSON.
    fn reporting(command: &clap::Command, before: &str) -> Vec<String> {
        let name = |own: &clap::Command| format!("{before} {}", own.get_name()).trim().to_owned();
        let below = command.get_subcommands().flat_map(|own| match own.has_subcommands() {
            true => reporting(own, &name(own)),
            false if own.get_arguments().any(|argument| argument.get_id() == "format") => vec![name(own)],
            false => Vec::new(),
        });
        below.collect()
    }

    #[test]
    fn every_report_is_described() {
        let reports = described();
        let mut described: Vec<&str> =
            reports.iter().map(|(name, _)| *name).filter(|name| *name != "info").collect();
        let mut writing = reporting(&description(), "");
        described.sort_unstable();
        writing.sort_unstable();
        assert_eq!(described, writing);
    }

    #[test]
    fn every_field_has_a_description() {
        for (command, schema) in described() {
            let schema = schema();
            let definitions = schema.get("$defs").and_then(|all| all.as_object());
            let own = definitions.into_iter().flatten().map(|(_, schema)| schema);
            for object in own.chain([schema.as_value()]) {
                for (name, field) in object["properties"].as_object().into_iter().flatten() {
                    assert!(field["description"].is_string(), "{command}: {name}");
                }
            }
        }
    }
}
