//! The program `voronudge`: its commands as the command line has them.

use crate::failure::Failure;
use crate::reporting::{Answer, Command, Described};
use crate::{command, command_line, configuration, terminal};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use serde_json::json;
use std::ffi::OsString;

/// Which forces move these cells, and what does the model of them miss?
#[derive(Debug, Parser)]
#[command(name = "voronudge", version, propagate_version = true, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: AnyCommand,
}

/// The commands: of each its name and the module below `command` with its `Arguments`.
macro_rules! commands {
    ($($name:ident: $module:ident,)*) => {
        /// A command as clap read it.
        #[derive(Debug, Subcommand)]
        pub(crate) enum AnyCommand {
            $($name(Box<command::$module::Arguments>),)*
        }

        impl AnyCommand {
            fn run(self) -> Result<Answer, Failure> {
                match self {
                    $(Self::$name(arguments) => (*arguments).run(),)*
                }
            }
        }

        /// The reports that commands write.
        pub(crate) fn described() -> Vec<Described> {
            [$(<command::$module::Arguments as Command>::described()),*].concat()
        }
    };
}

commands! {
    Infer: infer,
    Discover: discover,
    Evaluate: evaluate,
    Spectrum: spectrum,
    Observe: observe,
    Simulate: simulate,
    PhaseDiagram: phase_diagram,
    Merge: merge,
    Moduli: moduli,
    Channel: channel,
    EquationOfState: equation_of_state,
    EstimateChirality: estimate_chirality,
    CheckGradients: check_gradients,
    Import: import,
    Info: info,
    PhaseDiffusion: phase_diffusion,
    Rheology: rheology,
    Waves: waves,
    Schema: schema,
    Completions: completions,
    Man: man,
}

/// Runs the program as if it had been called with these arguments, of which the first is its own name. Returns the exit
/// code: 0, 1 if it ran but found no acceptable fit or a check failed, 2 for a fault that was told on stderr, 130 after Ctrl-C.
///
/// Once in a process: a command takes over SIGINT and SIGTERM, and sets the number of threads.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let mut words: Vec<OsString> = arguments.into_iter().collect();
    let configured = configuration::insert(&mut words, description);
    command_line::keep(&words);
    let failed = |failure: Failure| {
        terminal::note(&failure.to_string());
        if wants_json(command_line::typed()) {
            let fault =
                json!({"error": failure.message(), "hint": failure.hint(), "exit_code": failure.exit_code()});
            // Nothing more can be told when stdout is gone.
            let _ = terminal::print(&format!("{fault}\n"));
        }
        failure.exit_code()
    };
    if let Err(failure) = configured {
        return failed(failure);
    }
    match Arguments::try_parse_from(words) {
        Ok(arguments) => match arguments.command.run() {
            Ok(Answer::Positive) => 0,
            Ok(Answer::Negative) => 1,
            Err(end) if end.exit_code() == 0 => match terminal::print(end.message()) {
                Ok(()) => 0,
                Err(error) => failed(Failure::new(format!("stdout cannot be written: {error}"))),
            },
            Err(failure) => failed(failure),
        },
        Err(error) => match error.kind() {
            ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                // Nothing can be told when stdout is gone.
                let _ = error.print();
                error.exit_code() as u8
            }
            _ => failed(error.into()),
        },
    }
}

/// Whether results are asked for as JSON, and faults, too: seen in the words themselves, since a fault may be of these.
fn wants_json(words: &[String]) -> bool {
    let asked = words.windows(2).any(|pair| pair[0] == "--format" && pair[1] == "json");
    asked || words.iter().any(|word| word == "--format=json")
}

/// The commands with their options and help, as clap has them.
pub fn description() -> clap::Command {
    Arguments::command()
}

/// The command that was typed in these words, the first of which is the program's name.
pub(crate) fn parse<'a>(words: impl Iterator<Item = &'a str>) -> Result<AnyCommand, clap::Error> {
    Ok(Arguments::try_parse_from(words)?.command)
}
