//! Coefficients, trajectories and noise levels together, in as many steps of integration as it takes.

use super::begun::Begun;
use super::course::Course;
use super::fitted_movie::Fit;
use super::integrated::Integrated;
use super::movie::Movie;
use super::own_motion::OwnMotion;
use super::settling::FINAL;
use super::states::States;
use crate::inference::deviation;
use crate::search::Watch;
use crate::{CoefficientSpace, Error, Method, Request};

/// How often the error of the dynamics is raised to what a fit leaves, and by how many standard deviations that may exceed what is expected.
const LOOSENINGS: usize = 5;
const ACCEPTED_EXCESS: f64 = 2.5;

/// How often what integrating over the unknowns adds is found: where the first has led it is another. That of a similar model is a first.
const INTEGRATIONS: usize = 2;

/// Relative decrease of the objective that counts as none: at the end, and until it is known whether noise levels are too low.
const TOLERANCE: f64 = 5e-5;
const TOLERANCE_AT_LEVELS: f64 = 1e-3;

/// Fits a movie, perhaps from where another fit of it has come to, given the parameters to begin with.
pub(super) fn fit(
    movie: &Movie,
    states: States,
    request: &Request,
    space: &CoefficientSpace,
    from: Option<(&Fit, Vec<f64>)>,
    watch: &mut Watch<'_>,
) -> Result<Fit, Error> {
    let Begun { mut course, at, naive, mut states } = match from {
        Some(from) => Begun::further(movie, states, request, space, watch, from)?,
        None => Begun::new(movie, states, request, space, watch)?,
    };
    states.own_motion = OwnMotion::at(&course.objective(&states), &at)?;
    let at = course.integrate(&mut states, at)?;
    let (at, error) = course.finish(&states, at)?;
    let Course { rule, levels, memory, value, status, steps, trace, .. } = course;
    Ok(Fit { states, rule, parameters: at, levels, memory, naive, value, status, steps, trace, error })
}

impl Course<'_, '_> {
    /// Fit, noise levels and what integrating over the unknowns adds in turn, where cells crawl.
    fn integrate(&mut self, states: &mut States, mut at: Vec<f64>) -> Result<Vec<f64>, Error> {
        if self.memory.is_none() {
            return Ok(at);
        }
        for _ in usize::from(states.integrated.is_some())..INTEGRATIONS {
            at = self.settle(states, at, FINAL)?;
            match Integrated::at(&self.objective(states), &at) {
                Ok(integrated) => states.integrated = Some(integrated),
                // Where coefficients are not determined no ridge leads away from a fit.
                Err(Error::Degenerate | Error::Geometry { .. } | Error::Diverges { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(at)
    }

    /// Noise levels, and the minimum at these. Kinks where contacts change can keep a fit from the minimum that the likelihood expects:
    /// what is left then counts as error of the dynamics.
    fn finish(&mut self, states: &States, mut at: Vec<f64>) -> Result<(Vec<f64>, f64), Error> {
        let (mut start, error) = loop {
            let (settled, equations) = self.settled(states, at, FINAL)?;
            let (error, more) = self.refine(states, &settled)?;
            if !more {
                break ((settled, equations), error);
            }
            at = settled;
        };
        let most = match self.request.method {
            Method::Search { max_steps, .. } | Method::Descent { max_steps, .. } => max_steps,
        };
        for _ in 0..LOOSENINGS {
            // How much is left shows long before the end.
            let optimum = self.optimise(states, start, most, TOLERANCE_AT_LEVELS, (1, 1))?;
            let expected = self.objective(states).expected();
            let variance = self.levels.velocity.powi(2);
            let above = deviation(optimum.value / variance, expected / variance);
            if above < ACCEPTED_EXCESS || self.request.noise.velocity.is_some() {
                start = (optimum.parameters, optimum.equations);
                break;
            }
            self.levels.velocity *= optimum.value / expected;
            let equations = optimum.equations.map(|equations| self.renewed(states, equations));
            start = (optimum.parameters, equations);
        }
        Ok((self.optimise(states, start, most, TOLERANCE, (1, 1))?.parameters, error))
    }
}
