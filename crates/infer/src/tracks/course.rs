//! A fit on its way: optimiser, noise levels and steps of integration in turn.

use super::look::{Seen, Way};
use super::memory::Memory;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::rule::Rule;
use super::settling::{PASSING, Settling};
use super::states::States;
use crate::normal_equations::NormalEquations;
use crate::normal_matrix::invert;
use crate::search::{Optimum, Watch, optimise_knowing};
use crate::{CoefficientSpace, Error, NoiseLevels, Request, Status};
use std::ops::ControlFlow;

/// A finer rule must change the coefficients by less than this share of their standard errors.
const UNCHANGED: f64 = 0.2;

/// Steps from one frame to the next at most.
pub(super) const MOST_STEPS: usize = 16;

/// By what factor the error of the dynamics falls from one round to the next at most.
const FALL: f64 = 0.4;

/// Least error of the dynamics over the usual interval, in units of that of a position. Less would change no parameter, but hold cells so
/// stiffly to the model that a fit cannot get past changes of neighbours.
const LEAST_SHARE: f64 = 0.15;

/// The least error of the dynamics, as that of a mean velocity over an interval, for some error of a position.
pub(super) fn least_scatter(position: f64, interval: f64) -> f64 {
    LEAST_SHARE * position / interval
}

/// Relative decrease of the objective that counts as none on the way.
const TOLERANCE_ON_THE_WAY: f64 = 2e-4;

/// A point, and perhaps the problem linearised there.
pub(super) type Start = (Vec<f64>, Option<NormalEquations>);

/// A fit on its way.
pub(super) struct Course<'a, 'w> {
    movie: &'a Movie,
    pub(super) request: &'a Request,
    space: &'a CoefficientSpace,
    watch: &'a mut Watch<'w>,
    /// How the cells are followed from frame to frame.
    pub(super) rule: Rule,
    pub(super) levels: NoiseLevels,
    pub(super) memory: Option<Memory>,
    pub(super) value: f64,
    pub(super) status: Status,
    pub(super) steps: u64,
    pub(super) trace: Vec<f64>,
}

impl<'a, 'w> Course<'a, 'w> {
    pub fn new(
        movie: &'a Movie,
        request: &'a Request,
        space: &'a CoefficientSpace,
        watch: &'a mut Watch<'w>,
        (rule, levels, memory): (Rule, NoiseLevels, Option<Memory>),
    ) -> Self {
        let (value, status, steps, trace) = (f64::INFINITY, Status::StepLimit, 0, Vec::new());
        Self { movie, request, space, watch, rule, levels, memory, value, status, steps, trace }
    }
}

impl<'a> Course<'a, '_> {
    pub fn objective<'s>(&self, states: &'s States) -> MovieObjective<'s>
    where
        'a: 's,
    {
        MovieObjective {
            movie: self.movie,
            states,
            rule: self.rule,
            structure: &self.request.structure,
            space: self.space,
            levels: self.levels,
            memory: self.memory,
        }
    }

    /// A fit on the way to a better one.
    pub fn pass(&mut self, states: &States, at: Vec<f64>) -> Result<Vec<f64>, Error> {
        self.settle(states, at, PASSING)
    }

    /// Fit and noise levels in turn.
    pub(super) fn settle(&mut self, states: &States, at: Vec<f64>, how: Settling) -> Result<Vec<f64>, Error> {
        Ok(self.settled(states, at, how)?.0)
    }

    /// Fit and noise levels in turn; the problem is linearised at the end.
    pub(super) fn settled(&mut self, states: &States, at: Vec<f64>, how: Settling) -> Result<Start, Error> {
        let mut start = (at, None);
        let mut last = None;
        for round in 0..how.rounds {
            let optimum =
                self.optimise(states, start, how.steps, TOLERANCE_ON_THE_WAY, (round, how.rounds))?;
            let Optimum { parameters, equations, .. } = optimum;
            let objective = self.objective(states);
            let equations = match equations {
                Some(equations) => equations,
                None => objective.linearise(&parameters)?,
            };
            let placed = objective.displaced(&parameters)?;
            let components = objective.explained_components(&placed, &parameters);
            let seen = Seen { objective, equations: &equations, components, known: self.request.noise };
            let way = Way::Draws(how.draws);
            let (wanted, memory) = match self.memory {
                Some(_) => {
                    let likely = seen.likely(way)?;
                    let free = objective.free_share(&placed, &parameters, likely.memory.speed);
                    // What is expected depends on how free it is: the mean of both does not swing.
                    let free = (free * likely.memory.free).sqrt();
                    (likely.levels, Some(Memory { free, ..likely.memory }))
                }
                None => (seen.towards(way, &mut last)?, None),
            };
            let longer = memory.zip(self.memory).map_or(0.0, |(next, present)| next.change(present));
            let next = self.tightened(wanted, how);
            let change = (next.position / self.levels.position).ln().abs()
                + (next.velocity / self.levels.velocity).ln().abs()
                + longer;
            (self.levels, self.memory) = (next, memory);
            start = (parameters, Some(self.renewed(states, equations)));
            if change < how.enough {
                break;
            }
        }
        Ok(start)
    }

    pub(super) fn optimise(
        &mut self,
        states: &States,
        start: Start,
        most: u64,
        tolerance: f64,
        round: (u64, u64),
    ) -> Result<Optimum, Error> {
        let objective = self.objective(states);
        let expected = objective.expected();
        let watch = &mut *self.watch;
        let mut observer = |_: u64, value: f64| match watch.tell("tracks", round, value / expected) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let optimum = optimise_knowing(&objective, start, most, tolerance, &mut observer)?;
        self.steps += optimum.steps;
        self.trace.push(optimum.value / self.levels.velocity.powi(2));
        (self.value, self.status) = (optimum.value, optimum.status);
        Ok(optimum)
    }

    /// A linearised problem at the present levels.
    pub(super) fn renewed(&self, states: &States, equations: NormalEquations) -> NormalEquations {
        let objective = self.objective(states);
        let mut equations = equations.at_levels(self.levels);
        equations.hold(&objective.held());
        equations
    }

    /// The levels of the next round: the dynamics are tightened step by step.
    fn tightened(&self, wanted: NoiseLevels, how: Settling) -> NoiseLevels {
        let least = match self.request.noise.velocity {
            Some(_) => 0.0,
            None => least_scatter(wanted.position, self.movie.interval()),
        };
        let fallen = FALL * self.levels.velocity;
        let most = if how.tightens && self.memory.is_some() { fallen } else { f64::INFINITY };
        NoiseLevels { velocity: wanted.velocity.min(most).max(fallen).max(least), ..wanted }
    }

    /// Takes as many steps as the coefficients need at a point: what more would change, and whether they have become more.
    pub(super) fn refine(&mut self, states: &States, at: &[f64]) -> Result<(f64, bool), Error> {
        let before = self.rule;
        loop {
            let twice = self.rule.twice();
            let error = self.change(states, at, [self.rule, twice])?;
            if error < UNCHANGED || self.rule.steps() >= MOST_STEPS {
                return Ok((error, self.rule != before));
            }
            self.rule = twice;
        }
    }

    /// By how much one rule in place of another would change the coefficients: the largest change in standard errors. Infinite where these
    /// are not determined.
    fn change(&self, states: &States, at: &[f64], rules: [Rule; 2]) -> Result<f64, Error> {
        let [coarse, fine] = rules.map(|rule| MovieObjective { rule, ..self.objective(states) });
        let placed = coarse.displaced(at)?;
        let (before, after) = (coarse.residuals(&placed, at), fine.residuals(&fine.displaced(at)?, at));
        // A cell whose surroundings are close to something else goes anywhere: it counts no more than its error.
        let changed = after
            .iter()
            .zip(before)
            .map(|(after, before)| (after - before).cap_magnitude(self.levels.velocity));
        let changed = changed.collect();
        let reduced = coarse.response(&placed, at, changed)?;
        // A fit gone wrong tells nothing of the coefficients.
        let Ok(covariance) = invert(reduced.information.clone()) else { return Ok(f64::INFINITY) };
        let response = &covariance * &reduced.gradient;
        let covariance = covariance * self.levels.velocity.powi(2);
        let in_errors = response.iter().enumerate().map(|(k, d)| d.abs() / covariance[(k, k)].sqrt());
        Ok(in_errors.fold(0.0, f64::max))
    }
}
