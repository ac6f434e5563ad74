//! Sparse Levenberg–Marquardt as a solver for argmin.

use crate::Error;
use crate::normal_equations::{NormalEquations, Step};
use argmin::core::{
    CostFunction, Error as ArgminError, IterState, Jacobian, KV, Problem, Solver, State, TerminationReason,
    TerminationStatus,
};
use std::ops::ControlFlow;

/// How far a fit has come; the caller may stop it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'a> {
    /// What is being done, in a few words.
    pub stage: &'a str,
    /// Steps done and steps allowed.
    pub step: (u64, u64),
    /// Objective in units of its expected value.
    pub objective: f64,
}

/// Called after each step.
pub(crate) type Observer<'a> = &'a mut dyn FnMut(u64, f64) -> ControlFlow<()>;

pub(crate) type FitState = IterState<Vec<f64>, (), (), (), (), f64>;

/// Problems that can tell where a step fails.
pub(crate) trait Obstacles {
    /// The places (pairs of nudges) without which a step would gain about what it promises, if these are few.
    fn obstacles(&self, at: &[f64], trial: &[f64], promised: f64) -> Option<Vec<usize>>;
}

/// Damped Gauss–Newton on parameters and nudges together. The damping follows the ratio of actual to predicted
/// decrease; the cost is evaluated anew at every trial, with its own topology. Where a step fails at a few places only, these are held
/// and the others go on.
pub(crate) struct LevenbergMarquardt<'o> {
    damping: f64,
    growth: f64,
    /// Damping of single places beyond that of all; empty where none was ever held.
    held: Vec<f64>,
    /// Steps in a row that failed at a few places.
    evasions: u32,
    tolerance: f64,
    /// At the present point, once it is needed.
    linearised: Option<NormalEquations>,
    small_steps: u32,
    observer: Observer<'o>,
    interrupted: bool,
}

/// Damping beyond which no step is short enough.
const LARGEST_DAMPING: f64 = 1e8;

/// Accepted steps in a row that gain less than the tolerance, before the fit counts as converged. A single small gain
/// can be the crossing of a kink.
const SMALL_STEPS: u32 = 2;

/// How many times the tolerance a step promises at most that counts as one that gains little if it fails.
const LITTLE: f64 = 50.0;

/// Share of the promised decrease below which a step gained poorly.
const POOR: f64 = 0.25;

/// Parts of a step that are tried where all of it fails.
const SHARES: [f64; 3] = [0.4, 0.15, 0.05];

/// Damping of a place where a step failed, at first; by how much it grows there with each further failure; below which it is none.
const HELD: f64 = 1.0;
const TIGHTER: f64 = 10.0;
const LOOSE: f64 = 1e-2;

/// Failures in a row at a few places before the step as a whole is damped.
const MOST_EVASIONS: u32 = 4;

impl<'o> LevenbergMarquardt<'o> {
    pub fn new(tolerance: f64, observer: Observer<'o>) -> Self {
        Self {
            damping: 1e-3,
            growth: 2.0,
            held: Vec::new(),
            evasions: 0,
            tolerance,
            linearised: None,
            small_steps: 0,
            observer,
            interrupted: false,
        }
    }

    /// Starts from a point where the problem is linearised already.
    pub fn knowing(self, linearised: Option<NormalEquations>) -> Self {
        Self { linearised, ..self }
    }

    /// The problem linearised at the last point, if it was.
    pub fn into_linearised(self) -> Option<NormalEquations> {
        self.linearised
    }
}

impl LevenbergMarquardt<'_> {
    /// Holds the places at which a step failed, if they are few: the step without them.
    fn evade<O: Obstacles>(
        &mut self,
        problem: Option<&O>,
        at: &[f64],
        trial: &[f64],
        linearised: &NormalEquations,
        promised: f64,
    ) -> Option<Vec<f64>> {
        if self.evasions >= MOST_EVASIONS {
            return None;
        }
        let places = problem?.obstacles(at, trial, promised)?;
        self.held.resize(linearised.places(), 0.0);
        self.evasions += 1;
        let first = at.len() - 2 * linearised.places();
        let mut without = trial.to_vec();
        for place in places {
            let own = first + 2 * place..first + 2 * place + 2;
            without[own.clone()].copy_from_slice(&at[own]);
            self.held[place] = (self.held[place] * TIGHTER).max(HELD);
        }
        Some(without)
    }

    /// Lets held places go by and by.
    fn release(&mut self) {
        self.held.iter_mut().for_each(|held| *held = if *held > LOOSE { *held / 3.0 } else { 0.0 });
    }
}

impl<O> Solver<O, FitState> for LevenbergMarquardt<'_>
where
    O: CostFunction<Param = Vec<f64>, Output = f64>
        + Jacobian<Param = Vec<f64>, Jacobian = NormalEquations>
        + Obstacles,
{
    fn name(&self) -> &str {
        "sparse Levenberg-Marquardt"
    }

    fn init(
        &mut self,
        problem: &mut Problem<O>,
        mut state: FitState,
    ) -> Result<(FitState, Option<KV>), ArgminError> {
        let start = state.take_param().ok_or_else(|| Error::Optimiser("no starting point".into()))?;
        let cost = problem.cost(&start)?;
        Ok((state.param(start).cost(cost), None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<O>,
        mut state: FitState,
    ) -> Result<(FitState, Option<KV>), ArgminError> {
        let (at, cost) = (
            state.take_param().ok_or_else(|| Error::Optimiser("no current point".into()))?,
            state.get_cost(),
        );
        let linearised = match self.linearised.take() {
            Some(linearised) => linearised,
            None => problem.jacobian(&at)?,
        };
        let Step { step, promised } = linearised.step(self.damping, &self.held)?;
        let mut trial: Vec<f64> = at.iter().zip(&step).map(|(x, s)| x + s).collect();
        let mut trial_cost = problem.cost(&trial)?;
        let evasion = match cost - trial_cost < POOR * promised {
            true => self.evade(problem.problem.as_ref(), &at, &trial, &linearised, promised),
            false => None,
        };
        let evaded = evasion.is_some();
        if let Some(without) = evasion {
            let other_cost = problem.cost(&without)?;
            if other_cost < trial_cost {
                (trial, trial_cost) = (without, other_cost);
            }
        }
        if trial_cost >= cost {
            // A step that crosses a kink: a part of it may not, and costs no factorisation.
            for share in SHARES {
                let part: Vec<f64> = at.iter().zip(&step).map(|(x, s)| x + share * s).collect();
                let part_cost = problem.cost(&part)?;
                if part_cost < cost {
                    (trial, trial_cost) = (part, part_cost);
                    break;
                }
            }
        }
        let gain = (cost - trial_cost) / promised.max(f64::MIN_POSITIVE);
        let next = if trial_cost < cost {
            let change = (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
            self.damping = (self.damping * if evaded { change.min(1.0) } else { change }).max(1e-12);
            self.growth = 2.0;
            self.evasions = 0;
            self.release();
            let small = cost - trial_cost <= self.tolerance * cost;
            self.small_steps = if small { self.small_steps + 1 } else { 0 };
            state.param(trial).cost(trial_cost)
        } else {
            self.linearised = Some(linearised);
            if !evaded {
                self.damping *= self.growth;
                self.growth *= 2.0;
            }
            // Nothing left to gain, to rounding; or little, and kinks are in the way.
            if promised <= self.tolerance * cost {
                self.small_steps = SMALL_STEPS;
            } else if promised <= LITTLE * self.tolerance * cost {
                self.small_steps += 1;
            }
            state.param(at).cost(cost)
        };
        self.interrupted = (self.observer)(next.get_iter() + 1, next.get_cost()).is_break();
        Ok((next, None))
    }

    fn terminate(&mut self, state: &FitState) -> TerminationStatus {
        let reason = if self.interrupted {
            TerminationReason::Interrupt
        } else if state.get_iter() > 0 && self.small_steps >= SMALL_STEPS {
            TerminationReason::SolverConverged
        } else if self.damping > LARGEST_DAMPING {
            TerminationReason::SolverExit("no shorter step decreases the objective".into())
        } else {
            return TerminationStatus::NotTerminated;
        };
        TerminationStatus::Terminated(reason)
    }
}
