//! `voronudge infer`: parameters of the model from snapshots, by nudged inference.

mod answers;
mod fit_options;
mod flow;
mod page;
mod prepare;
mod questions;
mod report;
mod scaling;
mod summary;
mod words;

use crate::Answer;
use crate::arguments::{CommonArguments, DataSetArguments};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use crate::snapshot::to_array;
use clap::{Args, ValueEnum};
use fit_options::FitArguments;
use flow::FlowArguments;
use prepare::Prepared;
use questions::UncertaintyArguments;
use std::process::Stdio;
use std::time::Duration;
use voronudge_geometry::Vector;
use voronudge_infer::{Inference, infer};
use voronudge_io::{DataSet, Difference, FrameSelection, OutputDirectory};

/// Infers K_A, K_P, P_0 and alpha from cell positions and velocities by nudged inference (NADA).
///
/// Velocities are read from the data set, of cells or on a grid, or derived from its tracked positions. Writes
/// report.json, report.html, nudged_positions.npy, predicted_velocities.npy and residual_velocities.npy (for a flow field
/// predicted_flow.npy and residual_flow.npy).
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    data: DataSetArguments,
    /// Frames to fit together: `6`, `4..16`, `4,7,9`; zero-based, end excluded [default: all that have velocities].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    /// How velocities are derived from positions where none are given.
    #[arg(long, value_name = "central|forward|backward", default_value_t = Difference::Central)]
    difference: Difference,
    /// Which mean velocity to remove first: drift of the stage shows as one.
    #[arg(long, value_enum, default_value_t = MeanToRemove::Auto)]
    remove_mean: MeanToRemove,
    /// Let a smooth flow be no concern of the model: polynomials of the position up to this degree, in each frame.
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u32).range(0..=6), allow_negative_numbers = true)]
    background: Option<u32>,
    /// In an open field of view, polygons larger than this multiple of the median area, or reaching farther than a
    /// regular hexagon of that size, are taken for the rim.
    #[arg(long, value_name = "FACTOR", default_value_t = 3.0, allow_negative_numbers = true)]
    largest_area: f64,
    /// Open report.html when done.
    #[arg(long)]
    open_report: bool,
    #[command(flatten)]
    flow: FlowArguments,
    #[command(flatten)]
    fit: FitArguments,
    #[command(flatten)]
    uncertainty: UncertaintyArguments,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeanToRemove {
    /// The median of each frame in an open field, unless velocities of cells are given; none otherwise.
    Auto,
    /// None.
    None,
    /// The median of the velocities used in each frame.
    PerFrame,
}

/// An objective this many times its expected value is no fit: the noise levels given, or the model, are wrong.
const UNACCEPTABLE: f64 = 3.0;

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let mut run = Run::begin("infer", &arguments.common)?;
    if !(arguments.largest_area.is_finite() && arguments.largest_area > 0.0) {
        return Err(Failure::new(format!(
            "--largest-area is {}, but it must be finite and above zero",
            arguments.largest_area
        ))
        .with_hint("leave it out for 3 times the median area"));
    }
    let constraints = arguments.fit.constraints()?;
    arguments.fit.method()?;
    arguments.uncertainty.check(&constraints)?;
    let data = arguments.data.load()?;
    let mut out = OutputDirectory::create(arguments.common.required_out()?)?;
    let prepared = prepare::prepare(&arguments, constraints, &data, &mut run)?;
    let mut progress = Progress::new(arguments.common.verbosity());
    let fitted = infer(&prepared.observations, &prepared.request, &mut |state| {
        progress.step(state.stage, state.step.0, state.step.1)
    });
    let answered = fitted.and_then(|result| {
        let answers = arguments.uncertainty.ask(&prepared, &result, &mut progress)?;
        Ok((result, answers))
    });
    progress.finish();
    let (result, answers) = answered.map_err(|error| prepared.place(error, &arguments))?;
    let doubts = words::doubts(&result, &answers.profiles, prepared.request.method);
    doubts.iter().for_each(|doubt| run.warn(doubt));
    write_arrays(&mut out, &data, &prepared, &result)?;
    let report = report::report(&run, &data, &prepared, &result, &answers);
    let json = report.to_json()?;
    out.write_text("report.json", &json)?;
    out.write_text("report.html", &page::page(&arguments, &data, &prepared, &result, &report, &answers)?)?;
    let folder = out.path().to_owned();
    let summary = summary::summary(&report, &folder);
    run.finish(Some(out), &json, &summary)?;
    if arguments.open_report {
        open(&folder.join("report.html"));
    }
    let acceptable = result.objective <= UNACCEPTABLE * result.expected_objective;
    Ok(if acceptable { Answer::Positive } else { Answer::Negative })
}

fn write_arrays(
    out: &mut OutputDirectory,
    data: &DataSet,
    prepared: &Prepared,
    result: &Inference,
) -> Result<(), Failure> {
    type Field = fn(&Prepared, &Inference, usize) -> Vec<Vector<f64>>;
    let all = |field: Field| -> Vec<Vec<Vector<f64>>> {
        (0..prepared.snapshots.len()).map(|index| field(prepared, result, index)).collect()
    };
    let mut of_cells: Vec<(&str, Field)> = vec![
        ("nudged_positions.npy", Prepared::nudged_positions),
        ("predicted_velocities.npy", Prepared::predicted),
    ];
    match prepared.velocities.flow() {
        None => of_cells.push(("residual_velocities.npy", Prepared::residual_data)),
        Some(field) => {
            for (name, of) in [
                ("predicted_flow.npy", Prepared::predicted_data as Field),
                ("residual_flow.npy", Prepared::residual_data),
            ] {
                out.write_array(name, field.to_array(data, &all(of)).view())?;
            }
        }
    }
    for (name, field) in of_cells {
        let fields = all(field);
        let frames = prepared.snapshots.iter().zip(&fields).map(|(snapshot, f)| (snapshot, f.as_slice()));
        out.write_array(name, to_array(data, frames).view())?;
    }
    Ok(())
}

/// Time in which an opener shows whether it works.
const OPENING: Duration = Duration::from_millis(700);

/// Shows a page in the user's browser, where there is one.
fn open(page: &std::path::Path) {
    let opener = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let started = std::process::Command::new(opener)
        .arg(page)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    // An opener that fails does so at once; one that stays is the browser itself.
    let failed = started.map_or(true, |mut child| {
        std::thread::sleep(OPENING);
        matches!(child.try_wait(), Ok(Some(status)) if !status.success())
    });
    if failed {
        eprintln!("no browser could be started; open {} yourself", page.display());
    }
}
