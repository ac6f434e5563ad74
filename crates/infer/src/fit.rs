//! One nudged fit: continuation from loose to tight data, each stage run by argmin.

use crate::levenberg_marquardt::{LevenbergMarquardt, Observer};
use crate::objective::Objective;
use crate::{Error, NoiseLevels, Progress, Status};
use argmin::core::{Executor, TerminationReason, TerminationStatus};
use std::ops::ControlFlow;

/// Factors on σ_v while a fit is led from loose to tight data, the springs held: a stiff start keeps the nudges from
/// falling into a wrong topology.
const CONTINUATION: [f64; 5] = [10.0, 5.0, 2.5, 1.5, 1.0];

/// Steps at each stage of the continuation but the last.
const STEPS_PER_STAGE: u64 = 6;

/// Relative decrease of the objective that counts as none.
const TOLERANCE: f64 = 1e-5;

/// One nudged fit.
pub(crate) struct Fit {
    pub parameters: Vec<f64>,
    pub status: Status,
    pub steps: u64,
    pub trace: Vec<f64>,
}

/// A nudged fit by continuation, from zero nudges and the given β.
pub(crate) fn nudged_fit(
    objective: &mut Objective<'_>,
    free: &[f64],
    levels: &NoiseLevels,
    max_steps: u64,
    stage: &str,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, Error> {
    let mut at = free.to_vec();
    at.resize(free.len() + objective.nudge_count(), 0.0);
    let mut fit = Fit { parameters: at, status: Status::StepLimit, steps: 0, trace: Vec::new() };
    let expected = levels.velocity.powi(2) * objective.nudge_count() as f64;
    let all_steps = STEPS_PER_STAGE * (CONTINUATION.len() as u64 - 1) + max_steps;
    for (index, factor) in CONTINUATION.into_iter().enumerate() {
        let last = index + 1 == CONTINUATION.len();
        objective.spring = levels.spring() * factor * factor;
        let (done, mut trace) = (fit.steps, std::mem::take(&mut fit.trace));
        let mut watch = |step: u64, value: f64| {
            trace.push(value);
            observe(Progress { stage, step: (done + step, all_steps), objective: value / expected })
        };
        let (parameters, status, steps) =
            optimise(objective, &fit.parameters, if last { max_steps } else { STEPS_PER_STAGE }, &mut watch)?;
        fit = Fit { parameters, status, steps: fit.steps + steps, trace };
    }
    Ok(fit)
}

fn optimise(
    objective: &Objective<'_>,
    start: &[f64],
    max_steps: u64,
    observer: Observer<'_>,
) -> Result<(Vec<f64>, Status, u64), Error> {
    let solver = LevenbergMarquardt::new(TOLERANCE, observer);
    let executor = Executor::new(objective, solver)
        .configure(|state| state.param(start.to_vec()).max_iters(max_steps))
        .ctrlc(false);
    let mut state = executor
        .run()
        .map_err(|error| match error.downcast::<Error>() {
            Ok(own) => own,
            Err(other) => Error::Optimiser(other.to_string()),
        })?
        .state;
    let status = match &state.termination_status {
        TerminationStatus::Terminated(TerminationReason::Interrupt) => return Err(Error::Interrupted),
        TerminationStatus::Terminated(TerminationReason::SolverConverged) => Status::Converged,
        TerminationStatus::Terminated(TerminationReason::SolverExit(_)) => Status::Stalled,
        _ => Status::StepLimit,
    };
    let parameters = state.take_best_param().ok_or_else(|| Error::Optimiser("no best point".into()))?;
    Ok((parameters, status, state.iter))
}
