//! What would be known of cells followed otherwise.

use super::anchors::Share;
use super::course::least_scatter;
use super::inference::Followed;
use super::laid::Laid;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::rule::Rule;
use super::states::States;
use crate::prospects::{Design, Informed, Prospects, growth_with_area, multiplied};
use crate::{CoefficientSpace, Error, Inference, KnownNoise, NoiseLevels, Request};
use nalgebra::DMatrix;
use voronudge_model::Structure;

/// By how much a scatter of the dynamics may exceed the least that a fit has and still be that.
const ROUNDING: f64 = 1.02;

impl Followed {
    /// What the fit would know if more, or better, had been measured.
    ///
    /// # Errors
    /// [`Error`] if the data do not determine the coefficients.
    pub fn prospects(
        &self,
        movie: &Movie,
        request: &Request,
        result: &Inference,
    ) -> Result<Prospects, Error> {
        let space = request.space()?;
        let (model, coefficients) = ((&request.structure, &space), result.coefficients.as_slice());
        let informed = self.informed(movie, model, coefficients, (request.noise, result))?;
        informed.prospects(&space, &request.constraints, result)
    }

    /// The information about the fit, on the coefficients of a model that may have more terms. Of cells that crawl nothing is said of half
    /// the interval: how much of what they do of themselves shows over a shorter time is a question of its own.
    pub(crate) fn informed(
        &self,
        movie: &Movie,
        (structure, space): (&Structure, &CoefficientSpace),
        coefficients: &[f64],
        (known, result): (KnownNoise, &Inference),
    ) -> Result<Informed, Error> {
        let objective = self.objective(movie, structure, space);
        let mut at = space.nearest(coefficients);
        at.extend(self.displacements());
        let placed = objective.displaced(&at)?;
        // What integrating over the unknowns adds is known of the terms of the fit alone; it moves coefficients, hardly the information.
        let equations = objective.linearise_at(&placed, &at, Share::Known)?;
        let excess = result.excess();
        let levels = objective.levels;
        let now = equations.reduced()?.information / (levels.velocity.powi(2) * excess);
        let sharper = self.scattering(
            NoiseLevels { position: 0.5 * levels.position, ..levels },
            (movie, movie.interval()),
            known,
        );
        let sharp = equations.reduced_at(sharper)?.information / (sharper.velocity.powi(2) * excess);
        let priors = equations.of_priors() / (levels.velocity.powi(2) * excess);
        let there: usize = objective.states.intervals.iter().map(|interval| interval.ends.len()).sum();
        let in_reach = objective.states.motions.len() as f64 / there as f64;
        let mut with = Vec::with_capacity(Design::ALL.len());
        match objective.memory {
            None => {
                let laid = Laid::new(objective, &placed, &at);
                let of = |movie: &Movie, levels: NoiseLevels, rule: Rule| -> Result<DMatrix<f64>, Error> {
                    let states = States::new(movie)?;
                    let objective = MovieObjective { movie, states: &states, rule, levels, ..objective };
                    let equations = objective.linearise(&objective.start(&at[..space.dimension()]))?;
                    Ok(equations.reduced()?.information / (levels.velocity.powi(2) * excess))
                };
                let longer = laid.longer(movie.frames())?;
                with.push((Design::TwiceTheFrames, of(&longer, levels, objective.rule)?));
                let halved = laid.halved();
                let levels = NoiseLevels { velocity: 2f64.sqrt() * levels.velocity, ..levels };
                let levels = self.scattering(levels, (movie, halved.interval()), known);
                with.push((Design::HalfTheInterval, of(&halved, levels, objective.rule.half())?));
            }
            Some(_) => {
                let frames = movie.frames() as f64;
                let longer = (2.0 * frames - 1.0) / (frames - 1.0);
                with.push((Design::TwiceTheFrames, multiplied(&now, &priors, longer)));
            }
        }
        with.push((Design::HalfThePositionNoise, sharp));
        let growth = growth_with_area(movie.domain, in_reach);
        with.push((Design::TwiceTheField, multiplied(&now, &priors, growth)));
        Ok(Informed { now, with })
    }

    /// The levels that a fit would have at an interval: where the dynamics scatter by the least that a fit of this movie has, they would again.
    fn scattering(
        &self,
        levels: NoiseLevels,
        (movie, interval): (&Movie, f64),
        known: KnownNoise,
    ) -> NoiseLevels {
        if known.velocity.is_some() || self.fit.memory.is_some() {
            return levels;
        }
        let own = self.fit.levels;
        let is_least = own.velocity <= ROUNDING * least_scatter(own.position, movie.interval());
        let least = least_scatter(levels.position, interval);
        NoiseLevels { velocity: if is_least { least } else { levels.velocity.max(least) }, ..levels }
    }
}
