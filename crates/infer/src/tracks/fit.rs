//! Coefficients, trajectories and noise levels together, on ever finer instants.

use super::finer::Finer;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::rule::Rule;
use super::states::States;
use crate::least_squares::{invert, within_bounds};
use crate::noise::{FIRST_POSITION_NOISE, Restricted, SMALLEST_VELOCITY_NOISE};
use crate::normal_equations::NormalEquations;
use crate::search::{Optimum, Watch, optimise_knowing};
use crate::{CoefficientSpace, Error, KnownNoise, Method, NoiseLevels, Request, Status};
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// A finer rule must change the coefficients by less than this share of their standard errors.
const UNCHANGED: f64 = 0.2;

/// Error of the dynamics at first, in units of the velocities: as much as the first coefficients leave open.
const FIRST_VELOCITY_NOISE: f64 = 0.3;

/// By what factor the error of the dynamics falls from one round to the next at most.
const FALL: f64 = 0.4;

/// How far fit and noise levels are brought together.
#[derive(Debug, Clone, Copy)]
struct Settling {
    /// Rounds of both at most.
    rounds: u64,
    /// Steps of the optimiser in a round.
    steps: u64,
    /// Change of log σ that counts as none.
    enough: f64,
}

/// With the first rule, whose errors the noise levels take up; with a finer one on the way; at the end.
const ROUGH: Settling = Settling { rounds: 5, steps: 2, enough: 0.7 };
const PASSING: Settling = Settling { rounds: 1, steps: 2, enough: f64::INFINITY };
const FINAL: Settling = Settling { rounds: 8, steps: 1, enough: 0.06 };

/// How often the error of the dynamics is raised to what a fit leaves, and by how much that may exceed what is expected.
const LOOSENINGS: usize = 3;
const ACCEPTED_EXCESS: f64 = 1.15;

/// Relative decrease of the objective that counts as none.
const TOLERANCE: f64 = 5e-5;

/// Gauss–Newton steps of the first coefficients, which are linear but for responses.
const FIRST_STEPS: usize = 4;

/// Spacing of log k at which the likelihood is looked at.
const SPACING: f64 = 1.0;

/// Fits with what finer steps add at the fit before.
const CORRECTIONS: usize = 3;

/// A fitted movie.
pub(super) struct Fit {
    pub states: States,
    pub parameters: Vec<f64>,
    pub levels: NoiseLevels,
    pub naive: Vec<f64>,
    pub value: f64,
    pub status: Status,
    pub steps: u64,
    /// Φ / σ_v² after each round.
    pub trace: Vec<f64>,
    /// Steps of the integration from one frame to the next.
    pub substeps: usize,
    /// By how much a finer rule would change the coefficients, the largest change in standard errors.
    pub error: f64,
}

/// A point, and perhaps the problem linearised there.
type Start = (Vec<f64>, Option<NormalEquations>);

/// A fit on its way.
pub(super) struct Course<'a, 'w> {
    movie: &'a Movie,
    request: &'a Request,
    space: &'a CoefficientSpace,
    watch: &'a mut Watch<'w>,
    levels: NoiseLevels,
    value: f64,
    status: Status,
    steps: u64,
    trace: Vec<f64>,
}

/// Fits a movie.
pub(super) fn fit(
    movie: &Movie,
    request: &Request,
    space: &CoefficientSpace,
    watch: &mut Watch<'_>,
) -> Result<Fit, Error> {
    let Begun { mut course, mut states, mut at, naive } = Begun::new(movie, request, space, watch)?;
    let (mut substeps, mut error) = (1, f64::INFINITY);
    for rule in &Rule::LADDER[1..] {
        let next = States::new(movie, *rule)?;
        let finer = Finer::new(&course.objective(&states), &at, &next)?;
        error = course.change(&states, &at, &finer.added)?;
        if error < UNCHANGED {
            break;
        }
        if rule.steps == 1 {
            states = next;
            at = course.pass(&states, finer.at)?;
        } else {
            substeps = rule.steps;
            at = course.correct(&mut states, at, &next, finer)?;
        }
    }
    at = course.finish(&states, at)?;
    let Course { levels, value, status, steps, trace, .. } = course;
    Ok(Fit { states, parameters: at, levels, naive, value, status, steps, trace, substeps, error })
}

/// A fit with the first rule.
pub(super) struct Begun<'a, 'w> {
    pub course: Course<'a, 'w>,
    pub states: States,
    pub at: Vec<f64>,
    /// The first coefficients.
    naive: Vec<f64>,
}

impl<'a, 'w> Begun<'a, 'w> {
    pub fn new(
        movie: &'a Movie,
        request: &'a Request,
        space: &'a CoefficientSpace,
        watch: &'a mut Watch<'w>,
    ) -> Result<Self, Error> {
        request.noise.check()?;
        let KnownNoise { position, velocity } = request.noise;
        let first = NoiseLevels {
            position: position.unwrap_or(FIRST_POSITION_NOISE),
            velocity: FIRST_VELOCITY_NOISE.max(velocity.unwrap_or(SMALLEST_VELOCITY_NOISE)),
        };
        let mut course = Course {
            movie,
            request,
            space,
            watch,
            levels: first,
            value: f64::INFINITY,
            status: Status::StepLimit,
            steps: 0,
            trace: Vec::new(),
        };
        let states = States::new(movie, Rule::TRAPEZOID)?;
        let naive = first_coefficients(&course.objective(&states))?;
        let mut at = course.objective(&states).start(&naive);
        at = course.settle(&states, at, ROUGH)?;
        Ok(Self { course, states, at, naive })
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
            structure: &self.request.structure,
            space: self.space,
            levels: self.levels,
        }
    }

    /// A fit on the way to a better one.
    pub fn pass(&mut self, states: &States, at: Vec<f64>) -> Result<Vec<f64>, Error> {
        self.settle(states, at, PASSING)
    }

    /// Fit and noise levels in turn.
    fn settle(&mut self, states: &States, at: Vec<f64>, how: Settling) -> Result<Vec<f64>, Error> {
        Ok(self.settled(states, at, how)?.0)
    }

    /// Fit and noise levels in turn; the problem is linearised at the end.
    fn settled(&mut self, states: &States, at: Vec<f64>, how: Settling) -> Result<Start, Error> {
        let mut start = (at, None);
        for round in 0..how.rounds {
            let optimum = self.optimise(states, start, how.steps, (round, how.rounds))?;
            let next = self.next_levels(&self.objective(states), &optimum.equations)?;
            let change = (next.position / self.levels.position).ln().abs()
                + (next.velocity / self.levels.velocity).ln().abs();
            self.levels = next;
            start = (optimum.parameters, Some(optimum.equations.at_levels(next)));
            if change < how.enough {
                break;
            }
        }
        Ok(start)
    }

    /// Noise levels, and the minimum at these. Kinks where contacts change can keep a fit from the minimum that the likelihood expects:
    /// what is left then counts as error of the dynamics.
    fn finish(&mut self, states: &States, at: Vec<f64>) -> Result<Vec<f64>, Error> {
        let mut start = self.settled(states, at, FINAL)?;
        let most = match self.request.method {
            Method::Search { max_steps, .. } | Method::Descent { max_steps, .. } => max_steps,
        };
        for _ in 0..LOOSENINGS {
            let optimum = self.optimise(states, start, most, (1, 1))?;
            let excess = optimum.value / self.objective(states).expected();
            if excess < ACCEPTED_EXCESS || self.request.noise.velocity.is_some() {
                return Ok(optimum.parameters);
            }
            self.levels.velocity *= excess.sqrt();
            start = (optimum.parameters, Some(optimum.equations.at_levels(self.levels)));
        }
        Ok(self.optimise(states, start, most, (1, 1))?.parameters)
    }

    fn optimise(
        &mut self,
        states: &States,
        start: Start,
        most: u64,
        round: (u64, u64),
    ) -> Result<Optimum, Error> {
        let objective = self.objective(states);
        let expected = objective.expected();
        let watch = &mut *self.watch;
        let mut observer = |_: u64, value: f64| match watch.tell("tracks", round, value / expected) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let optimum = optimise_knowing(&objective, start, most, TOLERANCE, &mut observer)?;
        self.steps += optimum.steps;
        self.trace.push(optimum.value / self.levels.velocity.powi(2));
        (self.value, self.status) = (optimum.value, optimum.status);
        Ok(optimum)
    }

    /// The levels of the next round: more likely ones, the dynamics tightened step by step.
    fn next_levels(
        &self,
        objective: &MovieObjective<'_>,
        equations: &NormalEquations,
    ) -> Result<NoiseLevels, Error> {
        let wanted = match self.request.noise {
            KnownNoise { position: Some(position), velocity: Some(velocity) } => {
                NoiseLevels { position, velocity }
            }
            known => {
                let components = objective.components() as f64;
                Restricted { equations, components, known }.towards(self.levels, SPACING)?
            }
        };
        Ok(NoiseLevels { velocity: wanted.velocity.max(FALL * self.levels.velocity), ..wanted })
    }

    /// Fits with what a finer rule adds to the displacements, found at one fit and put into the next. Derivatives are those of the coarse
    /// rule: they weigh the residuals, whose expected value at the truth is zero for any weights.
    fn correct(
        &mut self,
        states: &mut States,
        mut at: Vec<f64>,
        next: &States,
        mut finer: Finer,
    ) -> Result<Vec<f64>, Error> {
        for correction in 0..CORRECTIONS {
            if correction > 0 {
                finer = Finer::new(&self.objective(states), &at, next)?;
            }
            states.motions.iter_mut().zip(&finer.added).for_each(|(motion, added)| motion.added = *added);
            at = self.pass(states, at)?;
        }
        Ok(at)
    }

    /// By how much what a finer rule adds would change the coefficients: the largest change in standard errors.
    fn change(&self, states: &States, at: &[f64], added: &[Vector<f64>]) -> Result<f64, Error> {
        let objective = self.objective(states);
        let steps = states.rule.steps;
        let of_rows = states.motions.iter().zip(added).flat_map(|(motion, all)| {
            let each = (motion.added - all) * objective.unit(motion.interval) / steps as f64;
            std::iter::repeat_n(each, steps)
        });
        let reduced = objective.response(at, of_rows.collect())?;
        let covariance = invert(reduced.information.clone())?;
        let response = &covariance * &reduced.gradient;
        let covariance = covariance * self.levels.velocity.powi(2);
        let in_errors = response.iter().enumerate().map(|(k, d)| d.abs() / covariance[(k, k)].sqrt());
        Ok(in_errors.fold(0.0, f64::max))
    }
}

/// The coefficients by regression of the displacements on the mean of the forces at both ends.
fn first_coefficients(objective: &MovieObjective<'_>) -> Result<Vec<f64>, Error> {
    let p = objective.space.dimension();
    let mut free = DVector::zeros(p);
    for _ in 0..FIRST_STEPS {
        let at = objective.start(free.as_slice());
        let placed = objective.place(&at)?;
        let (mut normal, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
        let rows = objective.residuals(&placed, &at);
        for (x, rest) in objective.columns_without_middles(&placed).iter().zip(rows) {
            normal += x.transpose() * x;
            right += x.transpose() * DVector::from_column_slice(rest.as_slice());
        }
        let newton = invert(normal.clone())? * right;
        free = within_bounds(objective.space, free + newton, normal)?;
    }
    Ok(free.as_slice().to_vec())
}
