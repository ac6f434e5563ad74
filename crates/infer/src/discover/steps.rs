//! One step of the search: which candidate, if any, the model lacks most.

use super::candidate::Candidate;
use super::chance::Chance;
use super::lineup::{Lineup, Score, added_places};
use super::search::Search;
use crate::objective::Objective;
use crate::search::{Watch, refine};
use crate::tracks::{Followed, HintsOfDrives, Movie, Scatter, follow};
use crate::uncertainty::nudges;
use crate::{
    Activity, CoefficientSpace, CrossValidation, Drives, Error, Examination, Inference, NoiseLevels,
    Observation, Request, infer,
};
use voronudge_model::CellParameter;

/// Fall of `−2 log L` by which a candidate may be behind the first and is still refitted with it.
const CONTENDERS: f64 = 16.0;

/// Lead in `−2 log L` below which another effect could as well be the right one: under it, so large a lead of a wrong one has a
/// probability below `exp(−lead/2)`, 5 %.
pub(super) const LEAD: f64 = 6.0;

/// Candidates refitted at most to choose between them.
const MOST_CONTENDERS: usize = 5;

/// Steps of such a refit.
const STEPS: u64 = 25;

/// Level of an effect beside others, as a share of that of a first one: how the others are modelled is never quite right.
const BESIDE: f64 = 0.2;

/// Cells of all frames above which candidates are compared without a refit.
const LARGE: usize = 4000;

/// What does not change from step to step.
#[derive(Clone, Copy)]
pub(super) struct Setting<'a> {
    pub frames: &'a [Observation],
    /// The tracks of which these are the frames, if these are what is fitted.
    pub movie: Option<&'a Movie>,
    pub search: &'a Search,
    pub candidates: &'a [Candidate],
}

/// A model with some candidates added, fitted.
pub(super) struct Model {
    pub added: Vec<usize>,
    pub request: Request,
    pub inference: Inference,
    /// All candidates beside it.
    pub lineup: Lineup,
    /// Of tracks: where their fit has come to.
    pub followed: Option<Followed>,
    /// The frames with the weights that their velocities have in it, if some hardly count.
    weighed: Option<Vec<Observation>>,
    space: CoefficientSpace,
}

impl Model {
    /// The frames as they were fitted.
    pub fn frames<'a>(&'a self, given: &'a [Observation]) -> &'a [Observation] {
        self.weighed.as_deref().unwrap_or(given)
    }

    /// Whether all velocities count alike.
    pub fn is_plain(&self) -> bool {
        self.weighed.is_none()
    }

    /// What was minimised.
    pub fn objective<'a>(&'a self, frames: &'a [Observation]) -> Objective<'a> {
        self.objective_on(self.frames(frames))
    }

    /// The same for frames with other weights.
    pub fn objective_on<'a>(&'a self, frames: &'a [Observation]) -> Objective<'a> {
        let levels = self.inference.noise;
        Objective::new(frames, &self.request.structure, &self.space, levels)
    }

    /// Where it was least.
    pub fn point(&self, frames: &[Observation]) -> Vec<f64> {
        let mut at = self.space.nearest(self.inference.coefficients.as_slice());
        at.extend(nudges(frames, &self.inference).concat());
        at
    }
}

impl Setting<'_> {
    /// The request to fit the base model with candidates added.
    fn request(&self, added: &[usize]) -> Request {
        let base = &self.search.fit;
        let structure = added_places(&base.structure, self.candidates, added).structure;
        let any = |of: fn(&Candidate) -> bool| added.iter().any(|candidate| of(&self.candidates[*candidate]));
        Request {
            structure,
            activity: match (any(Candidate::is_of_polarity), any(Candidate::is_alignment)) {
                (true, false) => Activity::Polarity,
                (_, true) => Activity::Alignment,
                (false, false) => base.activity,
            },
            drives: Drives {
                contact_inhibition: any(|own| own.drives().contact_inhibition),
                velocity_alignment: any(|own| own.drives().velocity_alignment),
            },
            // That of tracks is part of their fit.
            cross_validation: match self.movie {
                Some(_) => base.cross_validation,
                None => CrossValidation::Skipped,
            },
            // Models that are kept are examined with their evidence.
            examination: Examination::Skipped,
            ..base.clone()
        }
    }

    /// Fits the base model with candidates added; where tracks are fitted, perhaps from where another model has come to.
    pub fn fit(
        &self,
        added: Vec<usize>,
        from: Option<&Model>,
        watch: &mut Watch<'_>,
    ) -> Result<Model, Error> {
        let request = self.request(&added);
        let Some(movie) = self.movie else {
            let inference = infer(self.frames, &request, watch.observe)?;
            return self.model(added, request, inference);
        };
        let coefficients = from.map_or(Vec::new(), |from| self.coefficients_of(from, &added));
        let from = from.and_then(|from| Some((from.followed.as_ref()?, coefficients.as_slice())));
        let (inference, followed) = follow(movie, &request, from, watch)?;
        let base = &self.search.fit;
        let lineup = Lineup::of_tracks((movie, &followed), base, self.candidates, &added, &inference)?;
        let (space, followed) = (request.space()?, Some(followed));
        Ok(Model { space, added, request, inference, lineup, followed, weighed: None })
    }

    /// A fit with all candidates beside it.
    pub fn model(&self, added: Vec<usize>, request: Request, inference: Inference) -> Result<Model, Error> {
        let weighed = inference.weighed(self.frames);
        let frames = weighed.as_deref().unwrap_or(self.frames);
        let lineup = Lineup::new(frames, &self.search.fit, self.candidates, &added, &inference)?;
        Ok(Model { space: request.space()?, added, request, inference, lineup, followed: None, weighed })
    }

    /// A model whose cells differ in some parameters, too. Its frames have the parameters of their cells.
    pub fn differing(
        &self,
        model: &Model,
        varied: Vec<CellParameter>,
        watch: &mut Watch<'_>,
    ) -> Result<Model, Error> {
        let request = Request { varied, ..model.request.clone() };
        let inference = infer(self.frames, &request, watch.observe)?;
        let weighed = inference.weighed(self.frames);
        let frames = weighed.as_deref().unwrap_or(self.frames);
        let frames = inference.differing(frames, &request.varied)?;
        let (candidates, added) = (self.candidates, model.added.clone());
        let lineup = Lineup::new(&frames, &self.search.fit, candidates, &added, &inference)?;
        let space = request.space()?;
        Ok(Model { space, added, request, inference, lineup, followed: None, weighed: Some(frames) })
    }

    /// Whether it takes too long to refit candidates that are close to each other.
    pub fn is_large(&self) -> bool {
        self.movie.is_some() || self.frames.iter().map(|frame| frame.positions.len()).sum::<usize>() > LARGE
    }

    /// Candidates that are descriptions and can be tested.
    pub fn descriptions(&self) -> Vec<usize> {
        let is_one = |k: &usize| !self.candidates[*k].is_named() && self.candidates[*k].columns.is_ok();
        (0..self.candidates.len()).filter(is_one).collect()
    }

    /// Candidates that may be named and are not part of a model.
    pub fn named(&self, added: &[usize]) -> Vec<usize> {
        (0..self.candidates.len())
            .filter(|k| self.candidates[*k].is_named() && self.candidates[*k].columns.is_ok())
            .filter(|k| !added.contains(k))
            .collect()
    }

    /// The adjusted p that an effect needs beside so many others.
    pub fn level(&self, others: usize) -> f64 {
        self.search.level * if others == 0 { 1.0 } else { BESIDE }
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
        let lineup = &model.lineup;
        let projected = lineup.beyond(&model.added);
        let on_offer = self.named(&model.added);
        let mut scores: Vec<(usize, Score)> =
            on_offer.iter().map(|k| (*k, projected.score(*k))).filter(|(_, s)| s.dimension > 0).collect();
        let chance = Chance::new(&projected, &on_offer, self.search.fit.seed);
        scores.retain(|(candidate, _)| !refused.contains(candidate));
        let smallest = scores.iter().map(|(_, score)| score.p).fold(1.0, f64::min);
        let level = self.level(model.added.len());
        if chance.adjusted(smallest) >= level {
            return Ok(None);
        }
        let worth = |score: &Score| score.statistic - self.price(lineup, score.dimension);
        scores.sort_by(|a, b| worth(&b.1).total_cmp(&worth(&a.1)));
        let best = scores.first().map_or(0.0, |(_, score)| worth(score));
        scores.retain(|(_, score)| {
            worth(score) > (best - CONTENDERS).max(0.0) && chance.adjusted(score.p) < level
        });
        scores.truncate(MOST_CONTENDERS);
        let chosen = if scores.len() > 1 && !self.is_large() {
            let levels = model.inference.noise;
            let values = watch.each("candidates", &scores, 1.0, |(candidate, score)| {
                let new = Some((*candidate, score.coefficients.as_slice()));
                let value = self.refined(model, levels, &model.added, new)?;
                Ok(value + self.price(lineup, score.dimension))
            })?;
            let least = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
            let best = (0..values.len()).min_by(least).unwrap_or(0);
            // What the measurement may do as well is what the measurement does.
            let of_measurement = |k: &usize| self.candidates[scores[*k].0].is_of_measurement();
            let is_close = |k: &usize| values[*k] < values[best] + LEAD;
            (0..values.len()).filter(of_measurement).filter(is_close).min_by(least).unwrap_or(best)
        } else {
            0
        };
        Ok(scores.get(chosen).map(|(candidate, _)| *candidate))
    }

    /// What may be next of the polarity of cells: that they have one, or, if they have, what turns it; each with by how much −2 log L falls
    /// at least, to a first approximation. None without tracks.
    pub fn of_polarity(&self, model: &Model, refused: &[usize]) -> Result<Vec<(usize, f64)>, Error> {
        let (Some(movie), Some(followed)) = (self.movie, &model.followed) else { return Ok(Vec::new()) };
        let has_one = model.added.iter().any(|candidate| self.candidates[*candidate].is_polarity());
        let is_next = if has_one { Candidate::turns_polarity } else { Candidate::is_polarity };
        let is_open = |k: &usize| {
            let own = &self.candidates[*k];
            is_next(own) && own.columns.is_ok() && !model.added.contains(k) && !refused.contains(k)
        };
        let open: Vec<usize> = (0..self.candidates.len()).filter(is_open).collect();
        let drives = match open.iter().any(|k| self.candidates[*k].drives().any()) {
            true => followed.hints_of_drives(movie, &model.request, &model.space)?,
            false => HintsOfDrives::default(),
        };
        let hint = |k: &usize| {
            let own = self.candidates[*k].drives();
            Ok::<f64, Error>(match (own.contact_inhibition, own.velocity_alignment) {
                (true, _) => drives.contact_inhibition,
                (_, true) => drives.velocity_alignment,
                _ => followed.hint_of_polarity(movie, &model.request, &model.space)?,
            })
        };
        open.iter().map(|k| Ok((*k, hint(k)?))).collect()
    }

    /// What the dynamics of a model scatter by, beside what it knows; `None` without tracks.
    pub fn scatter(&self, model: &Model) -> Result<Option<Scatter>, Error> {
        match (self.movie, &model.followed) {
            (Some(movie), Some(followed)) => followed.scatter(movie, &model.request, &model.space),
            _ => Ok(None),
        }
    }

    /// The least Φ/σ_v² of a model at other noise levels.
    pub fn at_levels(&self, model: &Model, levels: NoiseLevels, watch: &mut Watch<'_>) -> Result<f64, Error> {
        match (self.movie, &model.followed) {
            (Some(movie), Some(followed)) => {
                followed.at_levels(movie, &model.request.structure, &model.space, levels, watch)
            }
            _ => self.refined(model, levels, &model.added, None),
        }
    }

    /// Φ/σ_v² at given noise levels, refitted from a fit with those of its candidates that are kept, and a new one with the
    /// coefficients given.
    pub fn refined(
        &self,
        from: &Model,
        levels: NoiseLevels,
        kept: &[usize],
        new: Option<(usize, &[f64])>,
    ) -> Result<f64, Error> {
        let added: Vec<usize> = kept.iter().copied().chain(new.map(|(candidate, _)| candidate)).collect();
        let request = self.request(&added);
        let space = request.space()?;
        let mut coefficients = self.coefficients_of(from, &added);
        if let Some((_, values)) = new {
            let after = added_places(&self.search.fit.structure, self.candidates, &added);
            let places = after.effects.last().into_iter().flatten();
            places.zip(values).for_each(|(to, value)| coefficients[*to] = *value);
        }
        let mut start = space.nearest(&coefficients);
        start.extend(nudges(self.frames, &from.inference).concat());
        let objective = Objective::new(from.frames(self.frames), &request.structure, &space, levels);
        Ok(refine(&objective, start, STEPS)?.value / levels.velocity.powi(2))
    }

    /// The coefficients of a fitted model for one with candidates added, zero for those that are new.
    pub(super) fn coefficients_of(&self, from: &Model, added: &[usize]) -> Vec<f64> {
        let base = &self.search.fit.structure;
        let [before, after] = [&from.added, added].map(|own| added_places(base, self.candidates, own));
        let mut coefficients = vec![0.0; after.structure.dimension()];
        let mut copy = |to: &[usize], own: &[usize]| {
            to.iter().zip(own).for_each(|(to, own)| coefficients[*to] = from.inference.coefficients[*own]);
        };
        copy(&after.model, &before.model);
        for (candidate, places) in added.iter().zip(&after.effects) {
            if let Some(k) = from.added.iter().position(|own| own == candidate) {
                copy(places, &before.effects[k]);
            }
        }
        coefficients
    }
}
