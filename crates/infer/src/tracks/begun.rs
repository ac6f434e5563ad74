//! The beginning of a fit: first coefficients and trajectories, and noise levels settled roughly.

use super::course::{Course, MOST_STEPS};
use super::first::{forward_coefficients, naive_coefficients};
use super::fitted_movie::Fit;
use super::memory::Memory;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::own_motion::OwnMotion;
use super::rule::Rule;
use super::settling::ROUGH;
use super::states::States;
use crate::noise::{FIRST_POSITION_NOISE, SMALLEST_VELOCITY_NOISE};
use crate::search::Watch;
use crate::{CoefficientSpace, Error, KnownNoise, NoiseLevels, Request};

/// Steps from one frame to the next at least.
const FEWEST_STEPS: usize = 1;

/// What twice the steps may change of the motions at first, as a share of what is left of these (squared).
const FIRST_CHANGE: f64 = 1e-3;

/// Steps of the optimiser at the first noise levels, and the relative decrease of the objective that counts as none there.
const APPROACH: u64 = 40;
const TOLERANCE_AT_FIRST: f64 = 2e-3;

/// Error of the dynamics at first, in units of the velocities: as much as the first coefficients leave open.
const FIRST_VELOCITY_NOISE: f64 = 0.3;

/// A fit whose noise levels are settled roughly.
pub(super) struct Begun<'a, 'w> {
    pub course: Course<'a, 'w>,
    pub at: Vec<f64>,
    /// The first coefficients.
    pub naive: Vec<f64>,
    /// The unknowns.
    pub states: States,
}

impl<'a, 'w> Begun<'a, 'w> {
    pub fn new(
        movie: &'a Movie,
        mut states: States,
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
        let memory = (states.polarities.count() > 0).then(|| Memory::first(states.polarities.align()));
        let mut course = Course::new(movie, request, space, watch, (Rule::Trapezoid, first, memory));
        let naive = naive_coefficients(&course.objective(&states))?;
        let at = match course.memory {
            // Where cells crawl, what moves them beside the model leads them astray until it is known.
            Some(_) => {
                course.rule = Rule::RungeKutta(FEWEST_STEPS);
                course.resolve(&states, &naive);
                let at = course.objective(&states).start(&naive);
                states.own_motion = OwnMotion::at(&course.objective(&states), &at)?;
                at
            }
            None => {
                let at = course.foresee(&states, naive.clone())?;
                course.place_unseen(&states, at)?
            }
        };
        let at = course.approach(&states, at)?;
        let at = course.settle(&states, at, ROUGH)?;
        Ok(Self { course, at, naive, states })
    }

    /// From where the fit of a similar model of the same movie has come to.
    pub fn further(
        movie: &'a Movie,
        mut states: States,
        request: &'a Request,
        space: &'a CoefficientSpace,
        watch: &'a mut Watch<'w>,
        (earlier, at): (&Fit, Vec<f64>),
    ) -> Result<Self, Error> {
        let Fit { rule, levels, memory, .. } = *earlier;
        let memory = memory.map(|memory| match (states.polarities.align(), memory.alignment > 0.0) {
            (true, false) => Memory { alignment: Memory::first(true).alignment, ..memory },
            (false, true) => Memory { alignment: 0.0, ..memory },
            _ => memory,
        });
        let mut course = Course::new(movie, request, space, watch, (rule, levels, memory));
        let naive = naive_coefficients(&course.objective(&states))?;
        states.own_motion = OwnMotion::at(&course.objective(&states), &at)?;
        let integrated = earlier.states.integrated.as_ref().filter(|_| course.memory.is_some());
        states.integrated = integrated.filter(|own| own.is_of(space.dimension())).cloned();
        let at = course.approach(&states, at)?;
        Ok(Self { course, at, naive, states })
    }
}

impl Course<'_, '_> {
    /// The coefficients that follow the cells best from where they were seen in one frame to where they were seen in the next, in as many
    /// steps of integration as it takes.
    fn foresee(&mut self, states: &States, mut free: Vec<f64>) -> Result<Vec<f64>, Error> {
        self.rule = Rule::RungeKutta(FEWEST_STEPS);
        self.resolve(states, &free);
        loop {
            let before = self.rule;
            free = forward_coefficients(&self.objective(states), &free)?;
            self.resolve(states, &free);
            if self.rule == before {
                return Ok(self.objective(states).start(&free));
            }
        }
    }

    /// Takes as many steps as some coefficients need where the cells were seen: too few, and the motion leads anywhere.
    fn resolve(&mut self, states: &States, free: &[f64]) {
        let at = self.objective(states).start(free);
        let rests = |rule: Rule| {
            let objective = MovieObjective { rule, ..self.objective(states) };
            objective.displaced(&at).map(|placed| objective.residuals(&placed, &at)).ok()
        };
        let mut rule = self.rule;
        let mut coarse = rests(rule);
        while rule.steps() < MOST_STEPS {
            let fine = rests(rule.twice());
            if let (Some(coarse), Some(fine)) = (&coarse, &fine) {
                let whole: f64 = coarse.iter().map(|rest| rest.norm_squared()).sum();
                let changes = fine.iter().zip(coarse).map(|(fine, coarse)| (fine - coarse).norm_squared());
                if changes.sum::<f64>() < FIRST_CHANGE * whole {
                    break;
                }
            }
            (rule, coarse) = (rule.twice(), fine);
        }
        self.rule = rule;
    }

    /// Fits at the first noise levels in as many steps of integration as it takes. Levels are not estimated on the way: far from the
    /// minimum the likelihood takes for noise what a better fit would explain.
    fn approach(&mut self, states: &States, mut at: Vec<f64>) -> Result<Vec<f64>, Error> {
        loop {
            at = self.optimise(states, (at, None), APPROACH, TOLERANCE_AT_FIRST, (0, 1))?.parameters;
            if !self.refine(states, &at)?.1 {
                return Ok(at);
            }
        }
    }
}
