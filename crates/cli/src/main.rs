//! `voronudge`: which forces move these cells, and what does the model of them miss?

mod arguments;
mod boundary;
mod command;
mod failure;
mod memory;
mod output;
mod progress;
mod run;
mod terminal;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use failure::Failure;
use std::process::ExitCode;

/// Which forces move these cells, and what does the model of them miss?
#[derive(Debug, Parser)]
#[command(name = "voronudge", version, propagate_version = true, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
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
    EstimateChirality(command::estimate_chirality::Arguments),
    CheckGradients(command::check_gradients::Arguments),
    Import(Box<command::import::Arguments>),
    Info(command::info::Arguments),
    PhaseDiffusion(command::phase_diffusion::Arguments),
    Rheology(Box<command::rheology::Arguments>),
}

/// What a command that ran has to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Exit code 0.
    Positive,
    /// Exit code 1: it ran, but found no acceptable fit, or a check failed.
    Negative,
}

fn main() -> ExitCode {
    match run() {
        Ok(Answer::Positive) => ExitCode::SUCCESS,
        Ok(Answer::Negative) => ExitCode::from(1),
        Err(failure) => {
            terminal::note(&failure.to_string());
            ExitCode::from(failure.exit_code())
        }
    }
}

fn run() -> Result<Answer, Failure> {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => match error.kind() {
            // Printed as they are; they end the program.
            ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => error.exit(),
            _ => return Err(error.into()),
        },
    };
    match arguments.command {
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
        Command::EstimateChirality(arguments) => command::estimate_chirality::run(arguments),
        Command::CheckGradients(arguments) => command::check_gradients::run(arguments),
        Command::Import(arguments) => command::import::run(*arguments),
        Command::Info(arguments) => command::info::run(&arguments),
        Command::PhaseDiffusion(arguments) => command::phase_diffusion::run(arguments),
        Command::Rheology(arguments) => command::rheology::run(*arguments),
    }
}
