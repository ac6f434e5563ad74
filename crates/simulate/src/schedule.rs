//! Running a simulation for a time and recording frames of it.

use crate::{Error, Simulation};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use voronudge_observables::{BlockAverage, TransitionCounter, mean_square_velocity};

/// Steps of a schedule that no machine makes: a tissue of ten cells would take a year.
pub const MOST_STEPS: f64 = 1e12;

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

    /// Number of steps between two frames.
    ///
    /// # Errors
    /// [`Error::NoFrames`], [`Error::Duration`], [`Error::TimeStep`] and [`Error::TooManySteps`] for an impossible schedule.
    pub fn steps_per_frame(&self) -> Result<usize, Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        match self {
            Self { frames: 0, .. } => Err(Error::NoFrames),
            Self { time, .. } if !positive(*time) => Err(Error::Duration { time: *time }),
            Self { time_step, .. } if !positive(*time_step) => Err(Error::TimeStep { time_step: *time_step }),
            _ if self.time / self.time_step > MOST_STEPS => {
                Err(Error::TooManySteps { steps: self.time / self.time_step, limit: MOST_STEPS })
            }
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
    /// A frame of the schedule was reached.
    Frame(Frame<'a>),
    /// A step was made, and its frame shown: how many so far, and how many the schedule has.
    Step {
        /// Steps made.
        done: usize,
        /// Steps of the schedule.
        total: usize,
        /// The simulation after the step.
        simulation: &'a Simulation,
        /// What [`resume`] needs to go on from here.
        state: &'a RunState,
    },
}

/// How far a run has come, besides the state of its simulation.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunState {
    /// Steps made.
    pub steps: usize,
    /// `⟨v²⟩` after each step in the second half of the schedule.
    pub mean_square_velocity: BlockAverage,
    /// T1 transitions from step to step in the second half of the schedule.
    pub transitions: u64,
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
    /// The standard error of the time average, which knows of the correlation of the series; see [`BlockAverage`].
    pub mean_square_velocity_error: Option<f64>,
    /// T1 transitions per cell and time in the second half of the schedule; `None` as above.
    pub transition_rate: Option<f64>,
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
    resume(simulation, schedule, RunState::default(), &mut observe)
}

/// Goes on with a run of which a part was made: `simulation` is in the state that belongs to `state`.
///
/// The whole is, bit by bit, the run that was not interrupted.
///
/// # Errors
/// As [`run`].
///
/// ```
/// use std::ops::ControlFlow;
/// use voronudge_geometry::{Domain, PeriodicBox};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{Event, RandomPlacement, RunState, Schedule, Simulation, generator, resume, run};
/// let domain = PeriodicBox::new([4.0, 4.0]).map(Domain::Periodic)?;
/// let new = || -> Result<Simulation, Box<dyn std::error::Error>> {
///     let positions = RandomPlacement::new(16, PeriodicBox::new([4.0, 4.0])?).draw(&mut generator(1))?;
///     Ok(Simulation::new(positions, domain, Model::chiral_voronoi(&Parameters::default()))?)
/// };
/// let schedule = Schedule { time: 1.0, time_step: 0.01, frames: 5 };
/// let mut whole = new()?;
/// run(&mut whole, &schedule, |_| ControlFlow::Continue(()))?;
///
/// let (mut part, mut kept) = (new()?, RunState::default());
/// run(&mut part, &schedule, |event| match event {
///     Event::Step { done: 37, state, .. } => {
///         kept = state.clone();
///         ControlFlow::Break(())
///     }
///     _ => ControlFlow::Continue(()),
/// })?;
/// let mut rest = new()?.in_state(part.state().clone())?;
/// resume(&mut rest, &schedule, kept, |_| ControlFlow::Continue(()))?;
/// assert_eq!(rest.state(), whole.state());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resume(
    simulation: &mut Simulation,
    schedule: &Schedule,
    state: RunState,
    mut observe: impl FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<Summary, Error> {
    go_on(simulation, schedule, state, &mut observe)
}

/// The same, compiled here for all callers.
fn go_on(
    simulation: &mut Simulation,
    schedule: &Schedule,
    mut state: RunState,
    observe: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<Summary, Error> {
    let steps_per_frame = schedule.steps_per_frame()?;
    let time_step = schedule.frame_interval() / steps_per_frame as f64;
    let total = steps_per_frame * schedule.frames;
    let mut completion = Completion::Finished;
    let mut transitions = TransitionCounter::default();
    let mut counted = false;
    while state.steps < total {
        let counts = 2 * (state.steps + 1) > total;
        if counts && !counted {
            // The state that the first step to be counted starts from.
            transitions.count(simulation.tessellation());
            counted = true;
        }
        simulation.step(time_step)?;
        state.steps += 1;
        if counts {
            state.transitions += transitions.count(simulation.tessellation()) as u64;
            state.mean_square_velocity.add(mean_square_velocity(simulation.velocities()));
        }
        if state.steps.is_multiple_of(steps_per_frame) {
            let index = state.steps / steps_per_frame - 1;
            if observe(Event::Frame(Frame { index, simulation })).is_break() {
                completion = Completion::Stopped;
                break;
            }
        }
        let made = Event::Step { done: state.steps, total, simulation, state: &state };
        if observe(made).is_break() {
            completion = Completion::Stopped;
            break;
        }
    }
    let samples = state.mean_square_velocity.count();
    Ok(Summary {
        steps: state.steps,
        mean_square_velocity: state.mean_square_velocity.mean(),
        transition_rate: (samples > 0).then(|| {
            // Between walls images make the same transitions.
            state.transitions as f64 / (samples as f64 * time_step * simulation.tessellation().len() as f64)
        }),
        mean_square_velocity_error: state.mean_square_velocity.standard_error(),
        completion,
    })
}
