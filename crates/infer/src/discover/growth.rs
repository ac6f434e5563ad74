//! The model grows: what it lacks is added, and what does not stand the test is taken back.

use super::beside_others::without_each;
use super::crawling::{self, Crawling};
use super::null_data;
use super::ranking::Ranking;
use super::result::{Fate, NullSets, Ranked};
use super::steps::{Model, Setting};
use super::tested::Tested;
use crate::Error;
use crate::cross_validation::{Folds, Split};
use crate::predictive::Predictive;
use crate::search::Watch;

/// Effects refused because of velocities held out before the search ends.
const MOST_REFUSED: usize = 3;

/// A search under way.
pub(super) struct Growth<'a> {
    pub setting: Setting<'a>,
    pub base: &'a Model,
    pub ranking: Ranking,
    split: &'a Split,
    /// What the base model says of data held out.
    by_base: Unseen,
}

/// What a model says of data that its fit has not seen: how probable they are, or, of tracks, the errors.
struct Unseen {
    probability: Option<Predictive>,
    errors: Option<Folds>,
}

impl Unseen {
    /// Velocities count as much as in the fit of `judge`.
    fn new(
        setting: &Setting<'_>,
        (model, judge): (&Model, &Model),
        split: &Split,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        if let Some(followed) = &model.followed {
            return Ok(Self { probability: None, errors: followed.held_out.clone() });
        }
        let (objective, point) =
            (model.objective_on(judge.frames(setting.frames)), model.point(setting.frames));
        Ok(Self { probability: Predictive::new(&objective, &point, split, watch)?, errors: None })
    }

    /// By how much more probable another model makes them.
    fn likelihood_gain(&self, after: &Self) -> Option<[f64; 2]> {
        self.probability.as_ref().zip(after.probability.as_ref()).map(|(before, after)| before.gain(after))
    }

    /// Why another model is refused, if it is: they are not more probable, or, where that cannot be said, its errors are larger. (A small
    /// effect does not show in errors of single motions, which are mostly those of the positions.)
    fn reason_against(&self, after: &Self) -> Option<&'static str> {
        let is_no_better = self.likelihood_gain(after).is_some_and(|[value, error]| value <= error);
        let errors = self.errors.as_ref().zip(after.errors.as_ref());
        let is_worse = errors.is_some_and(|(before, after)| {
            let [value, error] = before.gain(after);
            value < -error
        });
        match (is_no_better, is_worse) {
            (true, _) => {
                Some("velocities held out do not become more probable by more than the standard error")
            }
            (_, true) => Some("motions held out are predicted worse by more than the standard error"),
            _ => None,
        }
    }
}

/// A model with effects added.
pub(super) struct Grown {
    pub model: Model,
    /// Each of its effects with all others in the model.
    pub tested: Vec<Tested>,
}

impl<'a> Growth<'a> {
    /// Before anything is added.
    pub fn new(
        setting: Setting<'a>,
        base: &'a Model,
        split: &'a Split,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let by_base = Unseen::new(&setting, (base, base), split, watch)?;
        Ok(Self { setting, base, ranking: Ranking::new(&setting, &base.lineup), split, by_base })
    }

    /// Adds what the model lacks, one effect after another, as long as velocities held out become more probable, and takes
    /// back what others make superfluous.
    pub fn grow(&mut self, watch: &mut Watch<'_>) -> Result<Option<Grown>, Error> {
        // Each with one effect more than the one before.
        let mut grown: Vec<(Model, Unseen)> = Vec::new();
        let mut refused: Vec<usize> = Vec::new();
        while refused.len() < MOST_REFUSED && grown.len() < self.setting.search.most_effects {
            let (current, before) =
                grown.last().map_or((self.base, &self.by_base), |(model, own)| (model, own));
            let (candidate, hinted) = self.lacking(current, &refused, watch)?;
            let Some(candidate) = candidate else {
                hinted.into_iter().for_each(|ranked| self.ranking.put(ranked));
                break;
            };
            let id = self.setting.candidates[candidate].effect.id;
            let (own, others): (Vec<Ranked>, Vec<Ranked>) =
                hinted.into_iter().partition(|ranked| ranked.effect.id == id);
            others.into_iter().for_each(|ranked| self.ranking.put(ranked));
            let added = current.added.iter().copied().chain([candidate]).collect();
            let model = match self.setting.fit(added, Some(current), watch) {
                Ok(model) => model,
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                // One candidate that leads a fit astray is no end of a search.
                Err(error) => {
                    own.into_iter().for_each(|ranked| self.ranking.put(ranked));
                    self.ranking.end(self.setting.candidates[candidate].effect, &Fate::NotFitted(error));
                    refused.push(candidate);
                    continue;
                }
            };
            let after = Unseen::new(&self.setting, (&model, &model), self.split, watch)?;
            let against = match current.is_plain() && model.is_plain() {
                true => before.reason_against(&after),
                // What is told apart from a fault by the effect counts for both.
                false => {
                    Unseen::new(&self.setting, (current, &model), self.split, watch)?.reason_against(&after)
                }
            };
            let crawling = Crawling::of(&self.setting, candidate, &model);
            let of_memory =
                crawling.as_ref().and_then(|own| own.reason_against(&self.setting, current.added.len()));
            let against = against.or(of_memory);
            if let Some(ranked) = crawling.map(|own| own.ranked(&self.setting)).or(own.into_iter().next()) {
                let is_chance = ranked.adjusted_p >= self.setting.level(current.added.len());
                let is_tried = self.setting.candidates[candidate].is_of_polarity();
                if is_tried && !is_chance && against.is_none() {
                    // What goes on from frame to frame made the other tests too sure of themselves.
                    self.ranking.renew(&self.setting, &model.lineup);
                }
                self.ranking.put(ranked);
                if is_tried && is_chance {
                    refused.push(candidate);
                    continue;
                }
            }
            if let Some(reason) = against {
                self.refuse(candidate, reason);
                refused.push(candidate);
                continue;
            }
            grown.push((model, after));
        }
        let mut models: Vec<Model> = grown.into_iter().map(|(model, _)| model).collect();
        let Some(model) = models.pop() else { return Ok(None) };
        let grown = self.tested(model, watch)?;
        let setting = self.setting;
        self.prune(grown, models, watch, |own, others| own.reason_against(setting.level(others)))
    }

    /// Takes back effects as improbable as which synthetic data without an effect have them too.
    pub fn confirm(
        &mut self,
        grown: Grown,
        null_sets: &NullSets,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Grown>, Error> {
        let level = self.setting.search.level;
        self.prune(grown, Vec::new(), watch, |own, _| {
            (null_data::probability(null_sets, own.p) >= level).then_some(
                "synthetic data without any effect, searched in the same way, lead to one as often",
            )
        })
    }

    /// Takes back one effect, for a reason, and what is then no more than chance.
    pub fn take_back(
        &mut self,
        grown: Grown,
        candidate: usize,
        reason: &'static str,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Grown>, Error> {
        let setting = self.setting;
        self.prune(grown, Vec::new(), watch, |own, others| match own.candidate == candidate {
            true => Some(reason),
            false => own.reason_against(setting.level(others)),
        })
    }

    /// By how much velocities held out become more probable with effects than without, and the standard error.
    pub fn likelihood_gain(&self, with: &Model, watch: &mut Watch<'_>) -> Result<Option<[f64; 2]>, Error> {
        let after = Unseen::new(&self.setting, (with, with), self.split, watch)?;
        if self.base.is_plain() && with.is_plain() {
            return Ok(self.by_base.likelihood_gain(&after));
        }
        Ok(Unseen::new(&self.setting, (self.base, with), self.split, watch)?.likelihood_gain(&after))
    }

    /// What a model lacks most: the polarity of cells, if more speaks for it than for any other candidate, because it makes all other tests
    /// too sure of themselves, or then what turns it; otherwise the best of these. With the polarity as it ranks beside the base model, to first
    /// order, and what may turn it.
    fn lacking(
        &self,
        model: &Model,
        refused: &[usize],
        watch: &mut Watch<'_>,
    ) -> Result<(Option<usize>, Vec<Ranked>), Error> {
        let setting = self.setting;
        let best = setting.lacking(model, refused, watch)?;
        let (mut hints, mut ranked) = (Vec::new(), Vec::new());
        for hint in setting.of_polarity(model, refused)? {
            let own = crawling::hinted(&setting, hint, model);
            if own.fate == Fate::Explained {
                hints.push(hint);
            }
            if setting.candidates[hint.0].turns_polarity() || model.added.is_empty() {
                ranked.push(own);
            }
        }
        let projected = model.lineup.beyond(&model.added);
        let rival = best.map_or(0.0, |candidate| projected.score(candidate).statistic);
        // Linearised about a fit without them; what is better than chance has more.
        let enough = |(k, hint): &&(usize, f64)| {
            *hint >= crawling::least_evidence(&setting, *k, model.added.len()) && *hint > rival
        };
        let polarity = hints.iter().filter(enough).max_by(|a, b| a.1.total_cmp(&b.1));
        Ok((polarity.map(|(k, _)| *k).or(best), ranked))
    }

    /// Takes back the effect with the largest p among those against which a reason speaks, as long as there is one. `fitted` are models
    /// that are fitted already.
    fn prune(
        &mut self,
        mut grown: Grown,
        mut fitted: Vec<Model>,
        watch: &mut Watch<'_>,
        reason_against: impl Fn(&Tested, usize) -> Option<&'static str>,
    ) -> Result<Option<Grown>, Error> {
        loop {
            let others = grown.tested.len() - 1;
            let weak = grown.tested.iter().filter_map(|own| Some((own, reason_against(own, others)?)));
            let Some((weakest, reason)) = weak.max_by(|a, b| a.0.p.total_cmp(&b.0.p)) else {
                return Ok(Some(grown));
            };
            let candidate = weakest.candidate;
            self.refuse(candidate, reason);
            let kept: Vec<usize> =
                grown.model.added.iter().copied().filter(|own| *own != candidate).collect();
            if kept.is_empty() {
                return Ok(None);
            }
            let model = match fitted.iter().position(|model| model.added == kept) {
                Some(k) => fitted.swap_remove(k),
                None => self.setting.fit(kept, Some(&grown.model), watch)?,
            };
            grown = self.tested(model, watch)?;
        }
    }

    fn tested(&self, model: Model, watch: &mut Watch<'_>) -> Result<Grown, Error> {
        let tested = without_each(&self.setting, self.base, &model, watch)?;
        Ok(Grown { model, tested })
    }

    fn refuse(&mut self, candidate: usize, reason: &'static str) {
        self.ranking.end(self.setting.candidates[candidate].effect, &Fate::NotConfirmed(reason));
    }
}
