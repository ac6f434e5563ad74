//! `voronudge infer`: parameters of the model from snapshots, by nudged inference.

mod answers;
mod method;
mod page;
mod questions;
mod report;
mod summary;
mod verdict;

use super::fit::{
    ConstraintArguments, Measured, Question, SnapshotArguments, arrays, browser, latent, words,
};
use crate::Answer;
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use clap::Args;
use method::MethodArguments;
use questions::UncertaintyArguments;
use voronudge_infer::infer;
use voronudge_io::{Difference, OutputDirectory};

/// Infers K_A, K_P, P_0 and alpha from cell positions and velocities by nudged inference (NADA).
///
/// Velocities are read from the data set, of cells or on a grid, or derived from its tracked positions. Writes
/// report.json, report.html, nudged_positions.npy, predicted_velocities.npy and residual_velocities.npy (for a flow field
/// predicted_flow.npy and residual_flow.npy), and latent_cells.npy, the cells that were not detected.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    snapshots: SnapshotArguments,
    /// How velocities are derived from positions where none are given.
    #[arg(long, value_name = "central|forward|backward", default_value_t = Difference::Central)]
    difference: Difference,
    /// Open report.html when done.
    #[arg(long)]
    open_report: bool,
    #[command(flatten)]
    latent: latent::LatentArguments,
    #[command(flatten)]
    known: ConstraintArguments,
    #[command(flatten)]
    method: MethodArguments,
    #[command(flatten)]
    uncertainty: UncertaintyArguments,
    #[command(flatten)]
    common: CommonArguments,
}

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let mut run = Run::begin("infer", &arguments.common)?;
    arguments.snapshots.check()?;
    arguments.latent.check()?;
    let constraints = arguments.known.constraints()?;
    let method = arguments.method.method()?;
    arguments.uncertainty.check(&constraints)?;
    let data = arguments.snapshots.data.load()?;
    let mut out = OutputDirectory::create(arguments.common.required_out()?)?;
    let velocities = Measured::new(&arguments.snapshots, &data, arguments.difference)?;
    if let Some(difference @ (Difference::Forward | Difference::Backward)) = velocities.derived() {
        run.warn(format!(
            "velocities are {difference} differences, which share the error of the position they start or end at: it acts \
             as a spurious force; central differences do not"
        ));
    }
    let frames = velocities.frames(&arguments.snapshots, &data)?;
    let seed = arguments.common.seed;
    let question =
        Question { arguments: &arguments.snapshots, data: &data, constraints, method, seed, scale: None };
    let mut prepared = question.prepare(velocities, frames, &mut run)?;
    let mut progress = Progress::new(arguments.common.verbosity());
    let completed = arguments.latent.complete(&mut prepared, &mut progress);
    let fitted = completed.and_then(|()| {
        infer(&prepared.observations, &prepared.request, &mut |state| {
            progress.step(state.stage, state.step.0, state.step.1)
        })
    });
    let answered = fitted.and_then(|result| {
        let answers = arguments.uncertainty.ask(&prepared, &result, &mut progress)?;
        Ok((result, answers))
    });
    progress.finish();
    let (result, answers) = answered.map_err(|error| prepared.place(error, &arguments.snapshots))?;
    let doubts = words::doubts(&result, &answers.profiles, prepared.request.method);
    doubts.iter().for_each(|(_, doubt)| run.warn(doubt));
    arrays::write(&mut out, "", &data, &prepared, &result)?;
    latent::write(&mut out, &data, &prepared, &result)?;
    let report = report::report(&run, &data, &prepared, &result, &answers);
    let json = report.to_json()?;
    out.write_text("report.json", &json)?;
    out.write_text("report.html", &page::page(&arguments, &data, &prepared, &result, &report, &answers)?)?;
    let folder = out.path().to_owned();
    let summary = summary::summary(&report, &folder);
    run.finish(Some(out), &json, &summary)?;
    if arguments.open_report {
        browser::open(&folder.join("report.html"));
    }
    Ok(if result.is_acceptable() { Answer::Positive } else { Answer::Negative })
}
