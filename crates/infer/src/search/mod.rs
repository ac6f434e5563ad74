//! The search for the least penalised objective.
//!
//! The objective has a kink, often a jump, wherever neighbours change, and so many minima. One fit is led from loose to
//! tight data; contacts that could as well be others are then flipped one after another; further starts within the
//! noise do the same. The best is kept.

mod continuation;
mod descent;
mod patch;
mod starts;
mod transitions;

pub(crate) use continuation::follow;
pub(crate) use descent::descend;

use crate::levenberg_marquardt::{LevenbergMarquardt, Observer};
use crate::normal_equations::NormalEquations;
use crate::objective::Objective;
use crate::placing::{Placing, Remembering};
use crate::{Error, Progress, Status};
use argmin::core::{Executor, OptimizationResult, TerminationReason, TerminationStatus};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Tasks at once between two reports of progress, whatever the number of threads.
pub(crate) const AT_ONCE: usize = 8;

/// Relative decrease of the objective that counts as none.
pub(crate) const TOLERANCE: f64 = 1e-5;

/// How far to search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Steps of one optimisation at the final noise levels.
    pub max_steps: u64,
    /// Starts in all.
    pub starts: usize,
    pub seed: u64,
}

/// The best point found, and the way to it.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub parameters: Vec<f64>,
    pub value: f64,
    pub status: Status,
    pub steps: u64,
    /// Φ after each step of the continuation and after each round of transitions of the best start.
    pub trace: Vec<f64>,
    pub transitions_tried: usize,
    pub transitions_made: usize,
    /// Φ at the end of each start.
    pub starts: Vec<f64>,
}

/// Tells the caller of progress, and hears whether to stop.
pub(crate) struct Watch<'w> {
    pub observe: &'w mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
}

impl Watch<'_> {
    pub fn tell(&mut self, stage: &str, step: (u64, u64), objective: f64) -> Result<(), Error> {
        match (self.observe)(Progress { stage, step, objective }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Interrupted),
        }
    }

    /// Independent tasks in parallel, told of by their number done.
    pub fn each<T: Sync, R: Send>(
        &mut self,
        stage: &str,
        tasks: &[T],
        objective: f64,
        task: impl Fn(&T) -> Result<R, Error> + Sync,
    ) -> Result<Vec<R>, Error> {
        let mut results = Vec::with_capacity(tasks.len());
        for chunk in tasks.chunks(AT_ONCE) {
            self.tell(stage, (results.len() as u64, tasks.len() as u64), objective)?;
            results.extend(chunk.par_iter().map(&task).collect::<Result<Vec<R>, Error>>()?);
        }
        Ok(results)
    }
}

/// Goes on from a point: transitions, and further starts.
pub(crate) fn improve(
    objective: &Objective<'_>,
    found: &mut Found,
    effort: &Effort,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    transitions::flip(objective, found, effort.max_steps, watch)?;
    found.starts = vec![found.value];
    for start in 1..effort.starts {
        starts::try_another(objective, found, effort, start, watch)?;
    }
    Ok(())
}

/// One optimisation at fixed noise levels.
pub(crate) struct Optimum {
    pub parameters: Vec<f64>,
    /// The problem linearised there, if a step from there was tried.
    pub equations: Option<NormalEquations>,
    pub value: f64,
    pub status: Status,
    pub steps: u64,
}

impl Optimum {
    /// As the result of a search.
    pub fn found(self, trace: Vec<f64>) -> Found {
        Found::by(self.parameters, self.value, self.status, self.steps, trace)
    }
}

impl Found {
    /// The end of one way from one start, no transitions tried.
    fn by(parameters: Vec<f64>, value: f64, status: Status, steps: u64, trace: Vec<f64>) -> Self {
        Self {
            starts: vec![value],
            parameters,
            value,
            status,
            steps,
            trace,
            transitions_tried: 0,
            transitions_made: 0,
        }
    }
}

/// Levenberg–Marquardt from a point, until a step gains less than the tolerance, as a share of the objective.
pub(crate) fn optimise<P: Placing>(
    objective: &P,
    start: Vec<f64>,
    max_steps: u64,
    tolerance: f64,
    observer: Observer<'_>,
) -> Result<Optimum, Error> {
    optimise_knowing(objective, (start, None), max_steps, tolerance, observer)
}

/// As [`optimise`], from a point where the problem may be linearised already.
pub(crate) fn optimise_knowing<P: Placing>(
    objective: &P,
    (start, linearised): (Vec<f64>, Option<NormalEquations>),
    max_steps: u64,
    tolerance: f64,
    observer: Observer<'_>,
) -> Result<Optimum, Error> {
    let solver = LevenbergMarquardt::new(tolerance, observer).knowing(linearised);
    let executor = Executor::new(Remembering::new(objective), solver)
        .configure(|state| state.param(start).max_iters(max_steps))
        .ctrlc(false);
    let OptimizationResult { solver, mut state, .. } = executor.run().map_err(own_error)?;
    let status = match &state.termination_status {
        TerminationStatus::Terminated(TerminationReason::Interrupt) => return Err(Error::Interrupted),
        TerminationStatus::Terminated(TerminationReason::SolverConverged) => Status::Converged,
        TerminationStatus::Terminated(TerminationReason::SolverExit(_)) => Status::Stalled,
        _ => Status::StepLimit,
    };
    let value = state.best_cost;
    let parameters = state.take_best_param().ok_or_else(|| Error::Optimiser("no best point".into()))?;
    let equations = solver.into_linearised();
    Ok(Optimum { parameters, equations, value, status, steps: state.iter })
}

/// The same without telling of progress.
pub(crate) fn refine(objective: &Objective<'_>, start: Vec<f64>, max_steps: u64) -> Result<Optimum, Error> {
    optimise(objective, start, max_steps, TOLERANCE, &mut |_, _| ControlFlow::Continue(()))
}

/// The error within argmin's.
fn own_error(error: argmin::core::Error) -> Error {
    match error.downcast::<Error>() {
        Ok(own) => own,
        Err(other) => Error::Optimiser(other.to_string()),
    }
}
