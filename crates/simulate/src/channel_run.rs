//! A run of a living tissue with profiles across its channel.

use crate::measure::ChannelRecorder;
use crate::{Error, LivingTissue};
use std::ops::ControlFlow;

/// How long to run a channel and what to average over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelSchedule {
    /// Time before averages begin, for the steady state to be reached; may be zero.
    pub relaxation: f64,
    /// Time of the averages.
    pub time: f64,
    /// Largest time step `Δt`.
    pub time_step: f64,
    /// Equal pieces of time whose scatter tells the errors; 32 is usual. They should be longer than correlations last.
    pub samples: usize,
    /// Bins across the channel, an even number.
    pub bins: usize,
}

impl ChannelSchedule {
    /// Number of steps of the relaxation and of a sample, and their equal length.
    ///
    /// # Errors
    /// [`Error::Duration`], [`Error::TimeStep`] and [`Error::NoFrames`] (of samples) for an impossible schedule.
    pub fn steps(&self) -> Result<([usize; 2], f64), Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if self.samples == 0 {
            return Err(Error::NoFrames);
        }
        if !positive(self.time) {
            return Err(Error::Duration { time: self.time });
        }
        if !(self.relaxation.is_finite() && self.relaxation >= 0.0) {
            return Err(Error::Duration { time: self.relaxation });
        }
        if !positive(self.time_step) {
            return Err(Error::TimeStep { time_step: self.time_step });
        }
        let sample = self.time / self.samples as f64;
        let steps = (sample / self.time_step * (1.0 - 1e-12)).ceil().max(1.0);
        let time_step = sample / steps;
        Ok(([(self.relaxation / time_step).ceil() as usize, steps as usize], time_step))
    }
}

/// What a run of a channel came to.
#[derive(Debug, Clone)]
pub struct ChannelRun {
    /// What was averaged.
    pub recorder: ChannelRecorder,
    /// Steps made.
    pub steps: usize,
    /// Least and largest number of cells on the way.
    pub cells: [usize; 2],
    /// Why the run ended before its time, if it did: extinction, or too many cells. What was averaged until then counts.
    pub ended: Option<Error>,
}

/// Runs a tissue by a schedule; `observe` sees it after each step, with the number of steps made and to make, and may stop the run.
///
/// # Errors
/// Of impossible schedules and of [`LivingTissue::step`], except [`Error::Extinct`] and [`Error::TooManyCells`], which end the run
/// with what was averaged so far.
///
/// ```
/// use std::ops::ControlFlow;
/// use voronudge_geometry::{Domain, PeriodicBox};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::*;
/// let cell_box = PeriodicBox::new([6.0, 6.0])?;
/// let positions = RandomPlacement::new(36, cell_box).draw(&mut generator(1))?;
/// let model = Model::chiral_voronoi(&Parameters::default());
/// let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
/// let turnover = Turnover {
///     extrusion: EdgeRate { rate: 0.8, decay_length: 1.4 },
///     proliferation: Proliferation::Replacing { decay_length: 0.25 },
///     injection: Injection::Vertex,
///     most_cells: 100,
///     seed: 1,
/// };
/// let mut tissue = LivingTissue::new(simulation, turnover)?;
/// let schedule = ChannelSchedule { relaxation: 1.0, time: 4.0, time_step: 0.01, samples: 16, bins: 8 };
/// let run = run_channel(&mut tissue, &schedule, |_, _, _| ControlFlow::Continue(()))?;
/// assert_eq!((run.steps, run.cells, run.ended), (500, [36, 36], None));
/// assert_eq!(run.recorder.folded_profile().density.len(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_channel(
    tissue: &mut LivingTissue,
    schedule: &ChannelSchedule,
    mut observe: impl FnMut(&LivingTissue, usize, usize) -> ControlFlow<()>,
) -> Result<ChannelRun, Error> {
    run_observed(tissue, schedule, &mut observe)
}

/// The same, compiled here for all callers.
fn run_observed(
    tissue: &mut LivingTissue,
    schedule: &ChannelSchedule,
    observe: &mut dyn FnMut(&LivingTissue, usize, usize) -> ControlFlow<()>,
) -> Result<ChannelRun, Error> {
    let ([relaxation, per_sample], time_step) = schedule.steps()?;
    let total = relaxation + per_sample * schedule.samples;
    let recorder = ChannelRecorder::new(tissue.channel(), schedule.bins)?;
    let cells = tissue.identities().len();
    let mut run = ChannelRun { recorder, steps: 0, cells: [cells, cells], ended: None };
    while run.steps < total {
        match tissue.step(time_step) {
            Ok(()) => {}
            Err(error @ (Error::Extinct { .. } | Error::TooManyCells { .. })) => {
                run.ended = Some(error);
                break;
            }
            Err(error) => return Err(error),
        }
        run.steps += 1;
        let cells = tissue.identities().len();
        run.cells = [run.cells[0].min(cells), run.cells[1].max(cells)];
        if run.steps > relaxation {
            run.recorder.add(tissue.last_step());
            if (run.steps - relaxation).is_multiple_of(per_sample) {
                run.recorder.end_sample();
            }
        }
        if observe(tissue, run.steps, total).is_break() {
            break;
        }
    }
    Ok(run)
}
