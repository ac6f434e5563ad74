//! Coefficients, trajectories and noise levels together, on ever finer instants.

use super::movie::Movie;
use super::objective::{MovieObjective, Placed};
use super::rule::Rule;
use super::states::{Place, States};
use crate::least_squares::{invert, within_bounds};
use crate::noise::{FIRST_POSITION_NOISE, Restricted, SMALLEST_VELOCITY_NOISE};
use crate::search::{Watch, optimise};
use crate::{CoefficientSpace, Error, KnownNoise, Method, NoiseLevels, Request, Status};
use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// A finer rule must change the coefficients by less than this share of their standard errors.
const UNCHANGED: f64 = 0.2;

/// Error of the dynamics at first, in units of the velocities: as much as the first coefficients leave open.
const FIRST_VELOCITY_NOISE: f64 = 0.3;

/// By what factor the error of the dynamics falls from one round to the next at most.
const FALL: f64 = 0.4;

/// Rounds of fit and noise levels.
const ROUNDS: usize = 8;

/// Steps of the optimiser in a round.
const STEPS: u64 = 2;

/// Relative decrease of the objective that counts as none.
const TOLERANCE: f64 = 5e-5;

/// Change of log σ that counts as none where the rule may be too coarse, and where it is fine enough.
const SETTLED: [f64; 2] = [0.3, 0.06];

/// Gauss–Newton steps of the first coefficients, which are linear but for responses.
const FIRST_STEPS: usize = 4;

/// Spacing of log k at which the likelihood is looked at.
const SPACING: f64 = 1.0;

/// Operations of one factorisation beyond which no finer rule is tried.
const LARGEST_WORK: f64 = 2e11;

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
    /// By how much a finer rule would change the coefficients, the largest change in standard errors.
    pub error: f64,
}

/// A fit on its way.
struct Course<'a, 'w> {
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
    let mut states = States::new(movie, Rule::TRAPEZOID)?;
    let naive = first_coefficients(&course.objective(&states))?;
    let mut at = course.objective(&states).start(&naive);
    let mut error = f64::INFINITY;
    at = course.settle(&states, at, SETTLED[0])?;
    for rule in &Rule::LADDER[1..] {
        let next = States::new(movie, *rule)?;
        let (start, change) = course.refine(&states, &next, &at)?;
        error = change;
        if error < UNCHANGED || work(&next) > LARGEST_WORK {
            break;
        }
        states = next;
        at = course.settle(&states, start, SETTLED[0])?;
    }
    at = course.settle(&states, at, SETTLED[1])?;
    at = course.finish(&states, at)?;
    let Course { levels, value, status, steps, trace, .. } = course;
    Ok(Fit { states, parameters: at, levels, naive, value, status, steps, trace, error })
}

impl<'a> Course<'a, '_> {
    fn objective<'s>(&self, states: &'s States) -> MovieObjective<'s>
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

    /// Fit and noise levels in turn until these change by no more than `enough`.
    fn settle(&mut self, states: &States, mut at: Vec<f64>, enough: f64) -> Result<Vec<f64>, Error> {
        for round in 0..ROUNDS {
            at = self.optimise(states, at, STEPS, round)?;
            let next = self.next_levels(&self.objective(states), &at)?;
            let change = (next.position / self.levels.position).ln().abs()
                + (next.velocity / self.levels.velocity).ln().abs();
            self.levels = next;
            if change < enough {
                break;
            }
        }
        Ok(at)
    }

    /// The minimum at the present levels.
    fn finish(&mut self, states: &States, at: Vec<f64>) -> Result<Vec<f64>, Error> {
        let most = match self.request.method {
            Method::Search { max_steps, .. } | Method::Descent { max_steps, .. } => max_steps,
        };
        self.optimise(states, at, most, ROUNDS)
    }

    fn optimise(
        &mut self,
        states: &States,
        at: Vec<f64>,
        most: u64,
        round: usize,
    ) -> Result<Vec<f64>, Error> {
        let objective = self.objective(states);
        let expected = objective.expected();
        let watch = &mut *self.watch;
        let mut observer = |_: u64, value: f64| match watch.tell(
            "tracks",
            (round as u64, ROUNDS as u64),
            value / expected,
        ) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let optimum = optimise(&objective, at, most, TOLERANCE, &mut observer)?;
        self.steps += optimum.steps;
        self.trace.push(optimum.value / self.levels.velocity.powi(2));
        (self.value, self.status) = (optimum.value, optimum.status);
        Ok(optimum.parameters)
    }

    /// The levels of the next round: more likely ones, the dynamics tightened step by step.
    fn next_levels(&self, objective: &MovieObjective<'_>, at: &[f64]) -> Result<NoiseLevels, Error> {
        let wanted = match self.request.noise {
            KnownNoise { position: Some(position), velocity: Some(velocity) } => {
                NoiseLevels { position, velocity }
            }
            known => {
                let equations = objective.linearise(at)?;
                let components = objective.components() as f64;
                Restricted { equations: &equations, components, known }.towards(self.levels, SPACING)?
            }
        };
        Ok(NoiseLevels { velocity: wanted.velocity.max(FALL * self.levels.velocity), ..wanted })
    }

    /// The point on finer instants, and by how much these would change the coefficients: the largest change in standard errors.
    fn refine(&self, states: &States, finer: &States, at: &[f64]) -> Result<(Vec<f64>, f64), Error> {
        let objective = self.objective(states);
        let placed = objective.place(at)?;
        let start = transfer(states, &placed, finer, at, self.space.dimension());
        let fine = MovieObjective { states: finer, ..objective };
        let left = |objective: &MovieObjective<'_>, residuals: Vec<Vector<f64>>| {
            let steps = objective.states.rule.steps;
            let motions = objective.states.motions.iter().zip(residuals.chunks_exact(steps));
            motions
                .map(|(motion, rests)| {
                    // Displacements, as the residuals of one step.
                    let all: Vector<f64> = rests.iter().sum();
                    ((motion.interval, motion.track), all / objective.unit(motion.interval))
                })
                .collect::<HashMap<_, _>>()
        };
        let with_fine = left(&fine, fine.residuals(&fine.place(&start)?, &start));
        let residuals = objective.residuals(&placed, at);
        let coarse = left(&objective, residuals);
        let steps = states.rule.steps;
        let change = states.motions.iter().flat_map(|motion| {
            let key = (motion.interval, motion.track);
            let changed = with_fine.get(&key).map_or_else(Vector::zeros, |fine| fine - coarse[&key]);
            let each = changed * objective.unit(motion.interval) / steps as f64;
            std::iter::repeat_n(each, steps)
        });
        let reduced = objective.response(at, change.collect())?;
        let covariance = invert(reduced.information.clone())?;
        let response = &covariance * &reduced.gradient;
        let covariance = covariance * self.levels.velocity.powi(2);
        let in_errors = response.iter().enumerate().map(|(k, d)| d.abs() / covariance[(k, k)].sqrt());
        Ok((start, in_errors.fold(0.0, f64::max)))
    }
}

/// About how many operations it takes to factorise the normal equations instant by instant.
fn work(states: &States) -> f64 {
    let unknowns = states.instants.iter().map(|instant| 2.0 * instant.tracks.len() as f64);
    unknowns.map(|n| 7.0 / 3.0 * n.powi(3)).sum()
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

/// A point on instants that are the same or twice as many: the new ones are where the middles were.
fn transfer(from: &States, placed: &Placed<'_>, to: &States, at: &[f64], p: usize) -> Vec<f64> {
    let (free, displacements) = at.split_at(p);
    let ratio = to.rule.steps / from.rule.steps;
    let mut next = free.to_vec();
    next.resize(p + 2 * to.blocks(), 0.0);
    for (index, instant) in to.instants.iter().enumerate() {
        let (before, is_new) = (index / ratio, index % ratio > 0);
        let known: HashMap<u32, Vector<f64>> = match is_new {
            false => {
                let positions = &placed.instants[before].0.positions;
                from.instants[before].tracks.iter().copied().zip(positions.iter().copied()).collect()
            }
            true => {
                let tracks = from.middles[before]
                    .ends
                    .iter()
                    .map(|ends| from.instants[before].tracks[ends[0] as usize]);
                tracks.zip(placed.middles[before].0.positions.iter().copied()).collect()
            }
        };
        for (track, place) in instant.tracks.iter().zip(&instant.place) {
            let (Place::Own(own), Some(r)) = (place, known.get(track)) else { continue };
            let displacement = r - to.start[*own as usize];
            let block = p + 2 * *own as usize;
            next[block..block + 2].copy_from_slice(displacement.as_slice());
        }
    }
    let [old, new] = [from, to].map(|states| 2 * states.drifts.0);
    next[p + new..].copy_from_slice(&displacements[old..]);
    next
}
