//! One step of the search: which candidate, if any, the model lacks most.

use super::candidate::Candidate;
use super::chance::Chance;
use super::lineup::{Lineup, Score, added_places};
use super::result::Search;
use crate::objective::Objective;
use crate::search::{Watch, refine};
use crate::uncertainty::nudges;
use crate::{CrossValidation, Error, Inference, Observation, Request, infer};

/// Fall of `−2 log L` by which a candidate may be behind the first and is still refitted with it.
const CONTENDERS: f64 = 16.0;

/// Candidates refitted at most to choose between them.
const MOST_CONTENDERS: usize = 5;

/// Steps of such a refit.
const STEPS: u64 = 25;

/// Cells of all frames above which candidates are compared without a refit.
pub(super) const LARGE: usize = 4000;

/// What does not change from step to step.
#[derive(Clone, Copy)]
pub(super) struct Setting<'a> {
    pub frames: &'a [Observation],
    pub search: &'a Search,
    pub candidates: &'a [Candidate],
}

/// A model with some candidates added, fitted.
pub(super) struct Model {
    pub added: Vec<usize>,
    pub request: Request,
    pub inference: Inference,
}

impl Setting<'_> {
    /// The request to fit the base model with candidates added.
    pub fn request(&self, added: &[usize]) -> Request {
        let base = &self.search.fit;
        let structure = added_places(&base.structure, self.candidates, added).structure;
        Request { structure, cross_validation: CrossValidation::Skipped, ..base.clone() }
    }

    /// Fits the base model with candidates added.
    pub fn fit(&self, added: Vec<usize>, watch: &mut Watch<'_>) -> Result<Model, Error> {
        let request = self.request(&added);
        let inference = infer(self.frames, &request, watch.observe)?;
        Ok(Model { added, request, inference })
    }

    /// All candidates beside a fitted model.
    pub fn lineup(&self, model: &Model) -> Result<Lineup, Error> {
        Lineup::new(self.frames, &self.search.fit, self.candidates, &model.added, &model.inference)
    }

    /// Candidates that may be named and are not part of a model.
    pub fn named(&self, added: &[usize]) -> Vec<usize> {
        (0..self.candidates.len())
            .filter(|k| self.candidates[*k].is_named() && self.candidates[*k].columns.is_ok())
            .filter(|k| !added.contains(k))
            .collect()
    }

    /// Price of coefficients, on the scale of `−2 log L`: each could have been any of those on offer.
    pub fn price(&self, lineup: &Lineup, coefficients: usize) -> f64 {
        let (p, offered) = (coefficients as f64, lineup.number_of_columns() as f64);
        if coefficients == 0 { 0.0 } else { 2.0 * p * (offered / p).ln().max(1.0) }
    }

    /// The candidate that a model lacks most, apart from some refused; `None` if that is no more than chance.
    pub fn lacking(
        &self,
        model: &Model,
        refused: &[usize],
        watch: &mut Watch<'_>,
    ) -> Result<Option<usize>, Error> {
        let lineup = self.lineup(model)?;
        let projected = lineup.beyond(&model.added);
        let on_offer = self.named(&model.added);
        let mut scores: Vec<(usize, Score)> =
            on_offer.iter().map(|k| (*k, projected.score(*k))).filter(|(_, s)| s.dimension > 0).collect();
        let chance = Chance::new(&projected, &on_offer, self.search.fit.seed);
        scores.retain(|(candidate, _)| !refused.contains(candidate));
        let smallest = scores.iter().map(|(_, score)| score.p).fold(1.0, f64::min);
        if chance.adjusted(smallest) >= self.search.level {
            return Ok(None);
        }
        let worth = |score: &Score| score.statistic - self.price(&lineup, score.dimension);
        scores.sort_by(|a, b| worth(&b.1).total_cmp(&worth(&a.1)));
        let best = scores.first().map_or(0.0, |(_, score)| worth(score));
        scores.retain(|(_, score)| {
            worth(score) > (best - CONTENDERS).max(0.0) && chance.adjusted(score.p) < self.search.level
        });
        scores.truncate(MOST_CONTENDERS);
        let cells: usize = self.frames.iter().map(|frame| frame.positions.len()).sum();
        let chosen = if scores.len() > 1 && cells <= LARGE {
            let values = watch.each("candidates", &scores, 1.0, |(candidate, score)| {
                let mut added = model.added.clone();
                added.push(*candidate);
                let value = self.refined(model, &model.added, &added, score.coefficients.as_slice())?;
                Ok(value + self.price(&lineup, score.dimension))
            })?;
            (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0)
        } else {
            0
        };
        Ok(scores.get(chosen).map(|(candidate, _)| *candidate))
    }

    /// `−2 log L` at the noise levels of a fitted model, refitted from it with other candidates: of `kept` ones with their
    /// coefficients, and of the last of `added` with those given.
    pub fn refined(&self, from: &Model, kept: &[usize], added: &[usize], last: &[f64]) -> Result<f64, Error> {
        let base = &self.search.fit.structure;
        let (old, new) =
            (added_places(base, self.candidates, &from.added), added_places(base, self.candidates, added));
        let request = self.request(added);
        let space = request.space()?;
        let mut coefficients = vec![0.0; request.structure.dimension()];
        let fitted = &from.inference.coefficients;
        new.model.iter().zip(&old.model).for_each(|(to, from)| coefficients[*to] = fitted[*from]);
        for (candidate, places) in added.iter().zip(&new.effects) {
            let before =
                from.added.iter().position(|own| own == candidate).filter(|_| kept.contains(candidate));
            match before {
                Some(k) => places
                    .iter()
                    .zip(&old.effects[k])
                    .for_each(|(to, from)| coefficients[*to] = fitted[*from]),
                None => places.iter().zip(last).for_each(|(to, c)| coefficients[*to] = *c),
            }
        }
        let mut start = space.nearest(&coefficients);
        start.extend(nudges(self.frames, &from.inference).concat());
        let levels = from.inference.noise;
        let objective =
            Objective { frames: self.frames, structure: &request.structure, space: &space, levels };
        Ok(refine(&objective, start, STEPS)?.value / levels.velocity.powi(2))
    }
}
