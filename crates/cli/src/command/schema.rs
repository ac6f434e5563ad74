//! `voronudge schema`: what is in a `report.json`, as a JSON Schema.

use super::{check_gradients, evaluate, import, info, simulate};
use crate::failure::Failure;
use crate::program::Answer;
use crate::terminal;
use clap::Args;
use schemars::Schema;
use serde_json::Value;
use voronudge_report as report;
use voronudge_report::schema_of;

/// Prints the JSON Schema of what a command writes as report.json (of info, what --json prints); without a name, the names.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The command: infer, or import tracks.
    #[arg(num_args = 0..=2)]
    command: Vec<String>,
}

/// A command, and what describes its report.
type Described = (&'static str, fn() -> Schema);

/// The commands that write one.
const DESCRIBED: [Described; 24] = [
    ("infer", schema_of::<report::InferReport>),
    ("discover", schema_of::<report::DiscoverReport>),
    ("evaluate", schema_of::<evaluate::Report>),
    ("spectrum", schema_of::<report::SpectrumReport>),
    ("observe", schema_of::<report::observe_report::ObserveReport>),
    ("simulate", schema_of::<simulate::Report>),
    ("phase-diagram", schema_of::<report::PhaseReport>),
    ("moduli", schema_of::<report::ModuliReport>),
    ("channel", schema_of::<report::ChannelReport>),
    ("equation-of-state", schema_of::<report::EquationOfStateReport>),
    ("estimate-chirality", schema_of::<report::ChiralityReport>),
    ("check-gradients", schema_of::<check_gradients::Report>),
    ("import trackmate", schema_of::<import::TracksReport>),
    ("import tracks", schema_of::<import::TracksReport>),
    ("import points", schema_of::<import::PointsReport>),
    ("import flow", schema_of::<import::FlowReport>),
    ("import labels", schema_of::<report::ShapeReport>),
    ("import outlines", schema_of::<report::ShapeReport>),
    ("import field", schema_of::<report::FieldReport>),
    ("info", schema_of::<info::Record>),
    ("phase-diffusion", schema_of::<report::PhaseDiffusionReport>),
    ("rheology", schema_of::<report::RheologyReport>),
    ("waves", schema_of::<report::WavesReport>),
    ("merge", schema_of::<report::PhaseReport>),
];

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

pub(crate) fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let wanted = arguments.command.join(" ");
    let names = DESCRIBED.map(|(name, _)| name);
    let printed = match DESCRIBED.iter().find(|(name, _)| *name == wanted) {
        Some((name, schema)) => serde_json::to_string_pretty(&of_command(name, schema()))?,
        None if wanted.is_empty() => names.join("\n"),
        None => {
            return Err(Failure::new(format!("{wanted}: no command of this name writes a report.json"))
                .with_hint(format!("there are {}", names.join(", "))));
        }
    };
    terminal::print(&format!("{printed}\n"))
        .map_err(|error| Failure::new(format!("stdout cannot be written: {error}")))?;
    Ok(Answer::Positive)
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
        let mut described: Vec<&str> =
            DESCRIBED.iter().map(|(name, _)| *name).filter(|name| *name != "info").collect();
        let mut writing = reporting(&description(), "");
        described.sort_unstable();
        writing.sort_unstable();
        assert_eq!(described, writing);
    }

    #[test]
    fn every_field_has_a_description() {
        for (command, schema) in DESCRIBED {
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
