//! Running a simulation for a time and recording frames of it.

use crate::{Error, Simulation, measure::mean_square_velocity};
use std::ops::ControlFlow;

/// How long to run and what to record.
///
/// Frame `k` of `F` is taken at `(k + 1) T / F` after the beginning: the last is the end of the run, and the beginning,
/// usually an artificial state, is none. The steps between two frames are equal and at most `time_step`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// Duration `T`.
    pub time: f64,
    /// Largest time step `Δt`.
    pub time_step: f64,
    /// Number of frames `F`.
    pub frames: usize,
}

impl Schedule {
    /// Time between frames `T / F`.
    ///
    /// ```
    /// use voronudge_simulate::Schedule;
    /// let schedule = Schedule { time: 3.0, time_step: 0.02, frames: 6 };
    /// assert_eq!(schedule.frame_interval(), 0.5);
    /// ```
    pub fn frame_interval(&self) -> f64 {
        self.time / self.frames as f64
    }

    fn steps_per_frame(&self) -> Result<usize, Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        match self {
            Self { frames: 0, .. } => Err(Error::NoFrames),
            Self { time, .. } if !positive(*time) => Err(Error::Duration { time: *time }),
            Self { time_step, .. } if !positive(*time_step) => Err(Error::TimeStep { time_step: *time_step }),
            // A quotient that exceeds a whole number by rounding alone is not rounded up.
            _ => Ok((self.frame_interval() / self.time_step * (1.0 - 1e-12)).ceil().max(1.0) as usize),
        }
    }
}

/// A moment of a run.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Number of the frame, from zero.
    pub index: usize,
    /// The simulation at that moment: positions, velocities, tessellation, time.
    pub simulation: &'a Simulation,
}

/// What an observer of a run is shown.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A step was made: how many so far, and how many the schedule has.
    Step {
        /// Steps made.
        done: usize,
        /// Steps of the schedule.
        total: usize,
    },
    /// A frame of the schedule was reached.
    Frame(Frame<'a>),
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completion {
    /// At the time scheduled.
    Finished,
    /// At the request of the observer.
    Stopped,
}

/// What a run came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Number of steps made.
    pub steps: usize,
    /// `⟨v²⟩` over cells and over the steps in the second half of the schedule; `None` if the run was stopped before.
    pub mean_square_velocity: Option<f64>,
    /// Whether the run was stopped.
    pub completion: Completion,
}

/// Runs `simulation` from where it is by `schedule`; `observe` sees every step and every frame and may stop the run.
///
/// # Errors
/// [`Error::NoFrames`], [`Error::Duration`] and [`Error::TimeStep`] for an impossible schedule, and the errors of
/// [`Simulation::step`]; the simulation then stands at the last step that went well.
///
/// ```
/// use std::ops::ControlFlow;
/// use voronudge_geometry::{Domain, PeriodicBox};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{Completion, Event, RandomPlacement, Schedule, Simulation, generator, run};
/// let cell_box = PeriodicBox::new([4.0, 4.0])?;
/// let positions = RandomPlacement::new(16, cell_box).draw(&mut generator(1))?;
/// let model = Model::chiral_voronoi(&Parameters::default());
/// let mut simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
/// let schedule = Schedule { time: 100.0, time_step: 0.02, frames: 1000 };
/// let summary = run(&mut simulation, &schedule, |event| match event {
///     Event::Frame(frame) if frame.index == 2 => ControlFlow::Break(()),
///     _ => ControlFlow::Continue(()),
/// })?;
/// assert_eq!(summary.completion, Completion::Stopped);
/// assert_eq!(summary.steps, 15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(
    simulation: &mut Simulation,
    schedule: &Schedule,
    mut observe: impl FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<Summary, Error> {
    let steps_per_frame = schedule.steps_per_frame()?;
    let time_step = schedule.frame_interval() / steps_per_frame as f64;
    let total = steps_per_frame * schedule.frames;
    let (mut steps, mut samples, mut sum) = (0, 0, 0.0);
    let mut completion = Completion::Finished;
    'run: for index in 0..schedule.frames {
        for _ in 0..steps_per_frame {
            simulation.step(time_step)?;
            steps += 1;
            if 2 * steps > total {
                sum += mean_square_velocity(simulation.velocities());
                samples += 1;
            }
            if observe(Event::Step { done: steps, total }).is_break() {
                completion = Completion::Stopped;
                break 'run;
            }
        }
        if observe(Event::Frame(Frame { index, simulation })).is_break() {
            completion = Completion::Stopped;
            break;
        }
    }
    let mean_square_velocity = (samples > 0).then(|| sum / f64::from(samples));
    Ok(Summary { steps, mean_square_velocity, completion })
}
