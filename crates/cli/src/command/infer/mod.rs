//! `voronudge infer`: parameters of the model from snapshots, by nudged inference.

mod page;
mod prepare;
mod report;
mod scaling;

use crate::Answer;
use crate::arguments::{CommonArguments, DataSetArguments};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use crate::snapshot::to_array;
use clap::{Args, ValueEnum};
use prepare::Prepared;
use std::process::Stdio;
use std::time::Duration;
use voronudge_geometry::Vector;
use voronudge_infer::{Constraints, Inference, Quantity, infer};
use voronudge_io::{DataSet, Difference, FrameSelection, OutputDirectory};

/// Infers K_A, K_P, P_0 and alpha from cell positions and velocities by nudged inference (NADA).
///
/// Velocities are read from the data set or derived from its tracked positions. Writes report.json, report.html,
/// nudged_positions.npy, predicted_velocities.npy and residual_velocities.npy.
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
    /// Hold a parameter: `--fix K_A=0.1` (repeatable), in the units of the data.
    #[arg(long, value_name = "NAME=VALUE", value_parser = fixed_parameter, allow_hyphen_values = true)]
    fix: Vec<(Quantity, f64)>,
    /// Which mean velocity to remove first: drift of the stage shows as one.
    #[arg(long, value_enum, default_value_t = MeanToRemove::Auto)]
    remove_mean: MeanToRemove,
    /// In an open field of view, polygons larger than this multiple of the median area, or reaching farther than a
    /// regular hexagon of that size, are taken for the rim.
    #[arg(long, value_name = "FACTOR", default_value_t = 3.0, allow_negative_numbers = true)]
    largest_area: f64,
    /// Steps of the optimiser at the last stage of each fit.
    #[arg(long, default_value_t = 60, allow_negative_numbers = true)]
    max_steps: u64,
    /// Open report.html when done.
    #[arg(long)]
    open_report: bool,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeanToRemove {
    /// The median of each frame if velocities are derived from tracks in an open field, none otherwise.
    Auto,
    /// None.
    None,
    /// The median velocity of the cells used in each frame.
    PerFrame,
}

fn fixed_parameter(text: &str) -> Result<(Quantity, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, for example K_A=0.1")?;
    let quantity = Quantity::from_name(name)
        .ok_or_else(|| format!("{name} is not a parameter; there are K_A, K_P, P_0, alpha and K_P_alpha"))?;
    let number: f64 = value.parse().map_err(|_| format!("{value} is not a number"))?;
    Ok((quantity, number))
}

impl Arguments {
    /// What is known of the parameters, in the units of the data.
    fn constraints(&self) -> Result<Constraints, Failure> {
        let mut constraints = Constraints::default();
        for (quantity, value) in &self.fix {
            if constraints.fixed.insert(*quantity, *value).is_some() {
                return Err(Failure::new(format!("--fix: {} is fixed twice", quantity.name()))
                    .with_hint("give each parameter at most once"));
            }
        }
        Ok(constraints)
    }
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
    let data = arguments.data.load()?;
    let mut out = OutputDirectory::create(arguments.common.required_out()?)?;
    let prepared = prepare::prepare(&arguments, &data, &mut run)?;
    let mut progress = Progress::new(arguments.common.verbosity());
    let result = infer(&prepared.observations, &prepared.request, &mut |state| {
        progress.step(state.stage, state.step.0, state.step.1)
    });
    progress.finish();
    let result = result.map_err(|error| prepared.place(error, &arguments))?;
    warn_about(&result, &mut run);
    write_arrays(&mut out, &data, &prepared, &result)?;
    let report = report::report(&run, &data, &prepared, &result);
    let json = report.to_json()?;
    out.write_text("report.json", &json)?;
    out.write_text("report.html", &page::page(&arguments, &data, &prepared, &result, &report)?)?;
    let folder = out.path().to_owned();
    let summary = report::summary(&report, &folder);
    run.finish(Some(out), &json, &summary)?;
    if arguments.open_report {
        open(&folder.join("report.html"));
    }
    let acceptable = result.objective <= UNACCEPTABLE * result.expected_objective;
    Ok(if acceptable { Answer::Positive } else { Answer::Negative })
}

fn warn_about(result: &Inference, run: &mut Run) {
    let excess = result.objective / result.expected_objective;
    if excess > 1.5 {
        run.warn(format!(
            "the objective is {excess:.1} times its expected value: the noise levels are too small, or the model lacks \
             something; intervals are widened accordingly"
        ));
    }
    if result.status == voronudge_infer::Status::StepLimit {
        run.warn("the fit used up its steps; raise --max-steps");
    }
}

fn write_arrays(
    out: &mut OutputDirectory,
    data: &DataSet,
    prepared: &Prepared,
    result: &Inference,
) -> Result<(), Failure> {
    let fields: Vec<[Vec<Vector<f64>>; 3]> =
        (0..prepared.snapshots.len()).map(|index| prepared.fields(result, index)).collect();
    for (k, name) in ["nudged_positions.npy", "predicted_velocities.npy", "residual_velocities.npy"]
        .into_iter()
        .enumerate()
    {
        let frames = prepared.snapshots.iter().zip(&fields).map(|(snapshot, f)| (snapshot, f[k].as_slice()));
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
