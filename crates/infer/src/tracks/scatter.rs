//! How far cells are moved at random, anew at every moment: what the dynamics scatter by.
//!
//! What the model leaves of a displacement has the variance σ_v² T h in each component, which is 2Dh of cells that diffuse. A fit always has such a
//! scatter, because it holds no cell more stiffly to the model than errors of positions are worth (see [`least_scatter`]). What speaks
//! for a scatter is by how much −2 log L falls from the least that a fit has to the likeliest one, positions with errors in either case.

use super::anchors::Share;
use super::fit::least_scatter;
use super::inference::Followed;
use super::likely::LESS_LIKELY;
use super::movie::Movie;
use crate::noise::{Likelihood, Restricted};
use crate::{CoefficientSpace, Error, Request};

/// Spacing of log k at which the likelihood is looked at, and how far from the fit.
const SPACING: f64 = 0.5;
const FURTHEST: i32 = 3;

/// Steps to an end of an interval, in log k, and halvings of the last.
const STEPS: i32 = 8;
const BISECTIONS: usize = 5;

/// What the dynamics scatter by, in the units of the movie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scatter {
    /// D
    pub diffusion: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
    /// By how much −2 log L, restricted, falls from the least scatter to this one.
    pub evidence: f64,
}

/// The likelihood of a fit as a function of k, near that of the fit.
struct OfSpring<'a> {
    restricted: Restricted<'a>,
    fitted: f64,
}

impl OfSpring<'_> {
    fn at(&self, log_k: f64) -> Result<Likelihood, Error> {
        self.restricted.likelihood(log_k)
    }

    /// The likeliest log k near the fit.
    fn likeliest(&self) -> Result<f64, Error> {
        let centre = self.fitted;
        let points: Vec<f64> =
            (-FURTHEST..=FURTHEST).map(|step| centre + SPACING * f64::from(step)).collect();
        let values = self.restricted.equations.each(&points, |log_k| Ok(self.at(*log_k)?.criterion))?;
        let best = (0..points.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
        let around = best.checked_sub(1).and_then(|k| values.get(k)).zip(values.get(best + 1));
        let aside = around.map_or(0.0, |(before, after)| {
            let bend = before + after - 2.0 * values[best];
            if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 }
        });
        Ok(points[best] + SPACING * aside)
    }

    /// Where the likelihood has fallen as far as the end of an interval, from log k on in steps.
    fn end(&self, from: f64, least: f64, step: f64) -> Result<f64, Error> {
        let is_within = |log_k: f64| Ok::<bool, Error>(self.at(log_k)?.criterion - least < LESS_LIKELY);
        let (mut inside, mut outside) = (from, from + step);
        for _ in 0..STEPS {
            if !is_within(outside)? {
                break;
            }
            (inside, outside) = (outside, outside + step);
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inside + outside);
            if is_within(middle)? { inside = middle } else { outside = middle }
        }
        Ok(outside)
    }
}

impl Followed {
    /// What the dynamics of a fit of cells that do not crawl scatter by; `None` if that was given.
    pub fn scatter(
        &self,
        movie: &Movie,
        request: &Request,
        space: &CoefficientSpace,
    ) -> Result<Option<Scatter>, Error> {
        if request.noise.velocity.is_some() {
            return Ok(None);
        }
        let objective = self.objective(movie, &request.structure, space);
        let at = &self.fit.parameters;
        let placed = objective.place(at)?;
        let components = objective.explained_components(&placed, at);
        let equations = &objective.linearise_at(&placed, at, Share::Known)?;
        let restricted = Restricted { equations, components, known: request.noise, held: None };
        let own = OfSpring { restricted, fitted: objective.levels.spring().ln() };
        let interval = movie.interval();
        let least = 2.0 * least_scatter(1.0, interval).ln();
        let log_k = own.likeliest()?.max(least);
        let Likelihood { criterion, variance } = own.at(log_k)?;
        let evidence = (own.at(least)?.criterion - criterion).max(0.0);
        let diffusion = |variance: f64| 0.5 * variance * interval;
        let end = |step: f64| Ok::<f64, Error>(diffusion(own.at(own.end(log_k, criterion, step)?)?.variance));
        let lower = if evidence < LESS_LIKELY { 0.0 } else { end(-SPACING)? };
        let interval = [lower, end(SPACING)?];
        Ok(Some(Scatter { diffusion: diffusion(variance), interval, evidence }))
    }
}
