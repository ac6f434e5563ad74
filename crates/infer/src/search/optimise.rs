//! One optimisation from a point at fixed noise levels.

use super::found::Found;
use crate::levenberg_marquardt::{LevenbergMarquardt, Observer};
use crate::normal_equations::NormalEquations;
use crate::objective::Objective;
use crate::placing::{Placing, Remembering};
use crate::{Error, Status};
use argmin::core::{Executor, OptimizationResult, TerminationReason, TerminationStatus};
use std::ops::ControlFlow;

/// Relative decrease of the objective that counts as none.
pub(super) const TOLERANCE: f64 = 1e-5;

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
pub(super) fn own_error(error: argmin::core::Error) -> Error {
    match error.downcast::<Error>() {
        Ok(own) => own,
        Err(other) => Error::Optimiser(other.to_string()),
    }
}
