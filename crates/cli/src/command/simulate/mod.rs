//! `voronudge simulate`: trajectories of the model in a periodic box.

mod chaos;
mod driving;
mod measurements;
mod movie;
mod outcome;
mod page;
mod recorder;
mod report;
mod sensitivity;
mod start;
mod surroundings;

use crate::arguments::{
    CellArguments, CommonArguments, EffectArguments, MovieArguments, ParameterArguments, SpreadArguments,
    environment, named,
};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use chaos::Measure;
use clap::{Args, ValueEnum};
use driving::DrivingArguments;
use outcome::Finished;
use recorder::{Kept, Recorder};
pub(crate) use report::Report;
use report::Request;
use sensitivity::Asked;
pub(crate) use start::{Start, StartArguments};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};
use surroundings::SurroundingsArguments;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Tessellation};
use voronudge_model::Model;
use voronudge_report::Units;
use voronudge_report::numbers::significant;
use voronudge_simulate::{
    Completion, Event, Method, RunState, Schedule, Shear, Simulation, recommended_time_step, resume,
};

/// Simulates the chiral Voronoi model in a periodic box. The output is a data set.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    /// Duration of the run.
    #[arg(long, default_value_t = 50.0, allow_negative_numbers = true)]
    time: f64,
    /// Time step; for the adaptive method, the largest one.
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    dt: f64,
    /// Number of frames to keep, evenly spaced. The last one is the end of the run.
    #[arg(long, default_value_t = 10, allow_negative_numbers = true)]
    frames: usize,
    /// Method of integration.
    #[arg(long, value_enum, default_value_t = MethodName::Rk4)]
    method: MethodName,
    /// Error of a displacement that the adaptive method allows in one step, in mean cell spacings.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-4, allow_negative_numbers = true)]
    tolerance: f64,
    #[command(flatten)]
    driving: DrivingArguments,
    /// Also measure the largest Lyapunov exponent, over a further run as long as this one. It costs about four times
    /// as much as the run.
    #[arg(long)]
    lyapunov: bool,
    /// Also differentiate the run with respect to some of K_A, K_P, P_0, alpha and coordinates of cells at the start,
    /// as in `alpha,P_0,y17` (the y of cell 17).
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    sensitivity: Vec<String>,
    #[command(flatten)]
    movie: MovieArguments,
    #[command(flatten)]
    surroundings: SurroundingsArguments,
    /// Continue the interrupted run in --out, or start one if there is none.
    #[arg(long, help_heading = "General")]
    resume: bool,
    /// Time between checkpoints, in seconds.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 30.0,
        allow_negative_numbers = true,
        help_heading = "General"
    )]
    checkpoint: f64,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    cells: CellArguments,
    #[command(flatten)]
    spreads: SpreadArguments,
    #[command(flatten)]
    effects: EffectArguments,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Classical fourth-order Runge–Kutta method with steps of one size.
    Rk4,
    /// Third-order Bogacki–Shampine method with step sizes from an error estimate.
    Adaptive,
}

impl Reporting for Arguments {
    const NAME: &'static str = "simulate";
    type Report = Report;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let mut parameters = self.parameters.resolve()?;
        let mut effects = self.effects.resolve()?;
        let every = Duration::try_from_secs_f64(self.checkpoint).map_err(|_| {
            Failure::new(format!("--checkpoint is {}, but it must be a time in seconds", self.checkpoint))
                .with_hint("leave --checkpoint out for 30 seconds")
        })?;
        self.movie.check_without_fit()?;
        let start = Start::of(&self.start, self.common.seed, self.frames)?;
        let (cells, lengths) = (start.positions.len(), start.cell_box.lengths());
        let (spreads, labels) = (self.spreads.resolve()?, start.labels.as_deref());
        spreads.idle(&parameters).into_iter().for_each(|idle| run.warn(idle));
        let own = self.cells.read(cells, labels, &mut parameters)?;
        let own = own.and(spreads.draw(cells, self.common.seed, &mut parameters)?)?;
        let of_cells = own.values(cells, labels);
        let labels = start.labels.clone().or_else(|| spreads.labels(cells, self.common.seed));
        let driving = self.driving.driving(&mut effects, self.surroundings.shear()?, self.common.seed)?;
        let domain = Domain::Periodic(start.cell_box);
        let tessellation = Tessellation::new(&start.positions, domain)?;
        let view = FieldOfView::everywhere().judge(&tessellation, &start.positions);
        let surroundings = environment(&tessellation, &start.positions, &view)?;
        let surroundings = own.of_all(surroundings, cells, labels.clone())?;
        let model = effects.add_to(Model::chiral_voronoi(&parameters), surroundings, domain)?;
        let request = Request {
            cells,
            box_lengths: lengths,
            start: start.origin,
            time: self.time,
            dt: self.dt,
            frames: self.frames,
            method: match self.method {
                MethodName::Rk4 => Method::RungeKutta4,
                MethodName::Adaptive => Method::BogackiShampine { tolerance: self.tolerance },
            },
            parameters: named(&parameters),
            of_cells,
            spreads,
            labels,
            effects,
            walls: self.surroundings.walls(),
            driving,
        };
        check_shear(&request, start.cell_box)?;
        let measure_chaos = chaos::asked(self.lyapunov, &request)?;
        let mut simulation = Simulation::new(start.positions, domain, model)?
            .with_method(request.method)?
            .with_driving(request.driving)?;
        if let Some(walls) = request.walls {
            simulation = simulation.with_walls(walls)?;
        }
        let schedule = Schedule { time: request.time, time_step: request.dt, frames: request.frames };
        let asked = Asked::of(&self.sensitivity, &parameters, &simulation, &schedule)?;
        let advised = recommended_time_step(&parameters, (start.cell_box.area() / cells as f64).sqrt());
        if request.method == Method::RungeKutta4 && request.dt > advised {
            run.warn(format!(
                "the time step {} is above the {} advised for these parameters; velocities can come out wrong by tens of per cent",
                request.dt,
                significant(advised, 2)
            ));
        }
        let inputs = self.start.file().into_iter().chain(self.parameters.file());
        let inputs = inputs.map(Path::to_owned).chain(self.cells.files());
        let folder = self.common.claim(inputs)?;
        let (mut recorder, kept) =
            Recorder::open(&folder, &request, schedule.steps_per_frame()?, every, self.resume)?;
        let mut so_far = RunState::default();
        if let Some(Kept { run, state }) = kept {
            so_far = run;
            simulation = simulation.in_state(state)?;
        }
        let steps_before = so_far.steps;
        let mut progress = Progress::new(self.common.verbosity());
        let begun = Instant::now();
        let (mut fault, mut last) = (None, so_far.clone());
        let outcome = resume(&mut simulation, &schedule, so_far, |event| {
            let written = match event {
                Event::Frame(frame) => recorder.frame(frame.simulation),
                Event::Step { done, total, simulation, state } => {
                    if done == total {
                        last = state.clone();
                    }
                    if progress.step("simulate", done as u64, total as u64).is_break() {
                        let kept = recorder.checkpoint(simulation, state);
                        fault = Some(kept.err().unwrap_or_else(|| interrupted(simulation.time())));
                        return ControlFlow::Break(());
                    }
                    recorder.after_step(simulation, state)
                }
            };
            match written {
                Ok(()) => ControlFlow::Continue(()),
                Err(failure) => {
                    fault = Some(failure);
                    ControlFlow::Break(())
                }
            }
        });
        if let Some(failure) = fault {
            progress.finish();
            return Err(failure);
        }
        let summary = match outcome {
            Ok(summary) => summary,
            Err(error) => {
                progress.finish();
                // It would fail in the same way again.
                let of_run =
                    (request, start.cell_box, Units { length: start.length_unit, time: start.time_unit });
                let told = (folder.path(), error.into());
                return Err(outcome::keep_partial(recorder, of_run, (&simulation, &schedule), told)?);
            }
        };
        debug_assert_eq!(summary.completion, Completion::Finished);
        let seconds = begun.elapsed().as_secs_f64();
        if measure_chaos == Measure::Chaos || asked.is_some() {
            // So that an interruption finds the run complete.
            recorder.checkpoint(&simulation, &last)?;
        }
        let lyapunov = match measure_chaos {
            Measure::Chaos => Some(chaos::exponent(&simulation, &request, &mut progress)?),
            Measure::NoChaos => None,
        };
        let differentiated = asked.map(|asked| asked.differentiate(&schedule, &mut progress)).transpose()?;
        progress.finish();
        let crossings = simulation.state().crossings;
        if crossings > 0 {
            run.warn(format!("cells crossed a wall {crossings} times and were put in front of it"));
        }
        let steps_per_second = (summary.steps - steps_before) as f64 / seconds;
        let finished = Finished {
            simulation: &simulation,
            schedule,
            summary,
            lyapunov,
            differentiated,
            steps_per_second,
        };
        let units = Units { length: start.length_unit, time: start.time_unit };
        outcome::finish(run, recorder, (request, start.cell_box, units), finished, self.movie)
    }
}

/// Refuses a shear that takes the box farther than numbers can follow, before the run gets there.
fn check_shear(request: &Request, start: PeriodicBox) -> Result<(), Failure> {
    let strain = match request.driving.shear {
        Some(Shear::Oscillatory { amplitude, .. }) => amplitude,
        Some(shear) => shear.strain(request.time),
        None => return Ok(()),
    };
    start.after_shear(strain).map(|_| ()).map_err(|error| {
        Failure::from(error)
            .at(format!("at the largest strain, {strain}"))
            .with_hint("shorten --time, and go on from the end with --start")
    })
}

fn interrupted(time: f64) -> Failure {
    Failure::interrupted_at(format!("interrupted at time {time:.6}; the run so far is kept"))
        .with_hint("the same command with --resume goes on from there")
}
