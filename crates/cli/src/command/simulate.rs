//! `voronudge simulate`: trajectories of the model in a periodic box.

use crate::Answer;
use crate::arguments::{ChosenEffects, CommonArguments, EffectArguments, ParameterArguments, environment};
use crate::command::evaluate::ModelParameters;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use clap::Args;
use ndarray::Array3;
use serde::Serialize;
use std::ops::ControlFlow;
use std::time::Instant;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Tessellation, Vector};
use voronudge_io::{Boundary, DataSet, OutputDirectory, YAxis};
use voronudge_model::Model;
use voronudge_report::infer_report::RunRecord;
use voronudge_simulate::measure::hexatic_order;
use voronudge_simulate::{
    Completion, Event, RandomPlacement, Schedule, Simulation, generator, recommended_time_step,
    run as simulate,
};

/// Simulates the chiral Voronoi model in a periodic box from random positions (RK4). The output is a data set.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Number of cells.
    #[arg(long, default_value_t = 100, allow_negative_numbers = true)]
    cells: usize,
    /// Periodic box [default: a square of unit area per cell].
    #[arg(long = "box", num_args = 2, value_names = ["LX", "LY"], allow_negative_numbers = true)]
    box_lengths: Option<Vec<f64>>,
    /// Duration.
    #[arg(long, default_value_t = 50.0, allow_negative_numbers = true)]
    time: f64,
    /// Time step.
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    dt: f64,
    /// Number of frames to keep, evenly spaced; the last at the end.
    #[arg(long, default_value_t = 10, allow_negative_numbers = true)]
    frames: usize,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    effects: EffectArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Cells times frames that are kept in memory: 16 GB of positions and velocities.
const LARGEST_RUN: usize = 500_000_000;

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    run: RunRecord,
    cells: usize,
    #[serde(rename = "box")]
    box_lengths: [f64; 2],
    time: f64,
    dt: f64,
    frames: usize,
    parameters: ModelParameters,
    #[serde(skip_serializing_if = "ChosenEffects::is_empty")]
    effects: ChosenEffects,
    mean_square_velocity: Option<f64>,
    hexatic_order: f64,
    steps: usize,
    steps_per_second: f64,
}

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let mut run = Run::begin("simulate", &arguments.common)?;
    let parameters = arguments.parameters.resolve()?;
    let effects = arguments.effects.resolve()?;
    let lengths = match arguments.box_lengths.as_deref() {
        Some(&[x, y]) => [x, y],
        _ => [(arguments.cells as f64).sqrt(); 2],
    };
    if arguments.cells == 0 {
        return Err(Failure::new("--cells is 0, but at least one cell is needed")
            .with_hint("leave --cells out for 100 cells"));
    }
    if arguments.cells.checked_mul(arguments.frames.max(1)).is_none_or(|kept| kept > LARGEST_RUN) {
        return Err(Failure::new(format!(
            "--frames {} of --cells {} are more positions than the {LARGEST_RUN} that can be kept",
            arguments.frames, arguments.cells
        ))
        .with_hint("keep fewer frames, or run fewer cells"));
    }
    let cell_box = PeriodicBox::new(lengths)?;
    let mut out = OutputDirectory::create(arguments.common.required_out()?)?;
    let positions =
        RandomPlacement::new(arguments.cells, cell_box).draw(&mut generator(arguments.common.seed))?;
    let domain = Domain::Periodic(cell_box);
    let tessellation = Tessellation::new(&positions, domain)?;
    let view = FieldOfView::new(&tessellation, &positions, f64::INFINITY);
    let surroundings = environment(&tessellation, &positions, &view)?;
    let model = effects.add_to(Model::chiral_voronoi(&parameters), surroundings, domain)?;
    let mut simulation = Simulation::new(positions, domain, model)?;
    let schedule = Schedule { time: arguments.time, time_step: arguments.dt, frames: arguments.frames };
    let advised = recommended_time_step(&parameters, (cell_box.area() / arguments.cells as f64).sqrt());
    if arguments.dt > advised {
        run.warn(format!(
            "the time step {} is above the {advised:.2e} advised for these parameters; velocities can come out wrong by tens of per cent",
            arguments.dt
        ));
    }
    let mut progress = Progress::new(arguments.common.verbosity());
    let shape = (arguments.frames, arguments.cells, 2);
    let (mut positions, mut velocities) = (Array3::zeros(shape), Array3::zeros(shape));
    let begun = Instant::now();
    let summary = simulate(&mut simulation, &schedule, |event| {
        let frame = match event {
            Event::Step { done, total } => return progress.step("simulate", done as u64, total as u64),
            Event::Frame(frame) => frame,
        };
        let fill = |array: &mut Array3<f64>, vectors: &[Vector<f64>]| {
            for (cell, v) in vectors.iter().enumerate() {
                array[(frame.index, cell, 0)] = v.x;
                array[(frame.index, cell, 1)] = v.y;
            }
        };
        fill(&mut positions, frame.simulation.positions());
        fill(&mut velocities, frame.simulation.velocities());
        ControlFlow::Continue(())
    })?;
    progress.finish();
    if summary.completion == Completion::Stopped {
        return Err(Failure::interrupted());
    }
    let seconds = begun.elapsed().as_secs_f64();
    let data = DataSet {
        positions,
        velocities: Some(velocities),
        flow: None,
        labels: None,
        boundary: Boundary::Periodic { lengths },
        frame_interval: schedule.frame_interval(),
        length_unit: "length".into(),
        time_unit: "time".into(),
        y_axis: YAxis::Up,
        unwrapped: true,
        position_noise: None,
        velocity_noise: None,
        inputs: Vec::new(),
    };
    data.save(&mut out)?;
    let report = Report {
        run: run.record(None),
        cells: arguments.cells,
        box_lengths: lengths,
        time: arguments.time,
        dt: arguments.dt,
        frames: arguments.frames,
        parameters: (&parameters).into(),
        effects,
        mean_square_velocity: summary.mean_square_velocity,
        hexatic_order: hexatic_order(simulation.tessellation(), simulation.positions()),
        steps: summary.steps,
        steps_per_second: summary.steps as f64 / seconds,
    };
    let json = serde_json::to_string_pretty(&report)?;
    out.write_text("report.json", &json)?;
    let text = format!(
        "{} cells, {} steps, {:.0} steps per second\nmean square velocity over the second half: {}\nwritten to {}\n",
        report.cells,
        report.steps,
        report.steps_per_second,
        report.mean_square_velocity.map_or("none".into(), |v| format!("{v:.4e}")),
        out.path().display()
    );
    run.finish(Some(out), &json, &text)?;
    Ok(Answer::Positive)
}
