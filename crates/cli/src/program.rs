//! The program `voronudge`: its commands as the command line has them.

use crate::failure::Failure;
use crate::{command, configuration, terminal};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use serde_json::json;
use std::ffi::OsString;
use std::sync::OnceLock;

/// Which forces move these cells, and what does the model of them miss?
#[derive(Debug, Parser)]
#[command(name = "voronudge", version, propagate_version = true, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Infer(Box<command::infer::Arguments>),
    Discover(Box<command::discover::Arguments>),
    Evaluate(command::evaluate::Arguments),
    Spectrum(Box<command::spectrum::Arguments>),
    Observe(command::observe::Arguments),
    Simulate(command::simulate::Arguments),
    PhaseDiagram(Box<command::phase_diagram::Arguments>),
    Merge(command::merge::Arguments),
    Moduli(Box<command::moduli::Arguments>),
    Channel(Box<command::channel::Arguments>),
    EquationOfState(command::equation_of_state::Arguments),
    EstimateChirality(command::estimate_chirality::Arguments),
    CheckGradients(command::check_gradients::Arguments),
    Import(Box<command::import::Arguments>),
    Info(command::info::Arguments),
    PhaseDiffusion(command::phase_diffusion::Arguments),
    Rheology(Box<command::rheology::Arguments>),
    Waves(command::waves::Arguments),
    Schema(command::schema::Arguments),
    Completions(command::completions::Arguments),
    Man(command::man::Arguments),
}

/// What a command that ran has to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Exit code 0.
    Positive,
    /// Exit code 1: it ran, but found no acceptable fit, or a check failed.
    Negative,
}

/// The words of the command line that runs, those of a file of --config among them.
static TYPED: OnceLock<Vec<String>> = OnceLock::new();

/// The words of the command line, the name of the program first.
pub(crate) fn typed() -> &'static [String] {
    TYPED.get().map_or(&[], Vec::as_slice)
}

/// Runs the program as if it had been called with these arguments, of which the first is its own name. Returns the exit
/// code: 0, 1 if it ran but found no acceptable fit or a check failed, 2 for a fault that was told on stderr, 130 after Ctrl-C.
///
/// Once in a process: a command takes over SIGINT and SIGTERM, and sets the number of threads.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let mut words: Vec<OsString> = arguments.into_iter().collect();
    let configured = configuration::insert(&mut words);
    TYPED.get_or_init(|| words.iter().map(|word| word.to_string_lossy().into_owned()).collect());
    let failed = |failure: Failure| {
        terminal::note(&failure.to_string());
        if wants_json(typed()) {
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
        Ok(arguments) => match call(arguments.command) {
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
pub(crate) fn parse<'a>(words: impl Iterator<Item = &'a str>) -> Result<Command, clap::Error> {
    Ok(Arguments::try_parse_from(words)?.command)
}

fn call(command: Command) -> Result<Answer, Failure> {
    match command {
        Command::Infer(arguments) => command::infer::run(*arguments),
        Command::Discover(arguments) => command::discover::run(*arguments),
        Command::Evaluate(arguments) => command::evaluate::run(arguments),
        Command::Spectrum(arguments) => command::spectrum::run(*arguments),
        Command::Observe(arguments) => command::observe::run(arguments),
        Command::Simulate(arguments) => command::simulate::run(arguments),
        Command::PhaseDiagram(arguments) => command::phase_diagram::run(*arguments),
        Command::Merge(arguments) => command::merge::run(arguments),
        Command::Moduli(arguments) => command::moduli::run(*arguments),
        Command::Channel(arguments) => command::channel::run(*arguments),
        Command::EquationOfState(arguments) => command::equation_of_state::run(arguments),
        Command::EstimateChirality(arguments) => command::estimate_chirality::run(arguments),
        Command::CheckGradients(arguments) => command::check_gradients::run(arguments),
        Command::Import(arguments) => command::import::run(*arguments),
        Command::Info(arguments) => command::info::run(&arguments),
        Command::PhaseDiffusion(arguments) => command::phase_diffusion::run(arguments),
        Command::Rheology(arguments) => command::rheology::run(*arguments),
        Command::Waves(arguments) => command::waves::run(arguments),
        Command::Schema(arguments) => command::schema::run(&arguments),
        Command::Completions(arguments) => command::completions::run(&arguments),
        Command::Man(arguments) => command::man::run(&arguments),
    }
}
