//! The model grows: what it lacks is added, and what does not stand the test is taken back.

use super::classes::{Tested, without_each};
use super::null_data;
use super::ranking::Ranking;
use super::result::NullSets;
use super::steps::{Model, Setting};
use crate::Error;
use crate::cross_validation::Split;
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
    /// How probable the base model makes velocities held out, where that can be said.
    by_base: Option<Predictive>,
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
        let by_base = predictive(&setting, base, split, watch)?;
        Ok(Self { setting, base, ranking: Ranking::new(&setting, &base.lineup), split, by_base })
    }

    /// Adds what the model lacks, one effect after another, as long as velocities held out become more probable, and takes
    /// back what others make superfluous.
    pub fn grow(&mut self, watch: &mut Watch<'_>) -> Result<Option<Grown>, Error> {
        let mut grown: Option<(Model, Option<Predictive>)> = None;
        let mut refused: Vec<usize> = Vec::new();
        while refused.len() < MOST_REFUSED
            && grown.as_ref().map_or(0, |(model, _)| model.added.len()) < self.setting.search.most_effects
        {
            let (current, before) =
                grown.as_ref().map_or((self.base, &self.by_base), |(model, own)| (model, own));
            let Some(candidate) = self.setting.lacking(current, &refused, watch)? else { break };
            let added = current.added.iter().copied().chain([candidate]).collect();
            let model = self.setting.fit(added, watch)?;
            let after = predictive(&self.setting, &model, self.split, watch)?;
            if gain(before, &after).is_some_and(|[value, error]| value <= error) {
                self.refuse(
                    candidate,
                    "velocities held out do not become more probable by more than the standard error",
                );
                refused.push(candidate);
                continue;
            }
            grown = Some((model, after));
        }
        let Some((model, _)) = grown else { return Ok(None) };
        let grown = self.tested(model, watch)?;
        let level = self.setting.search.level;
        self.prune(grown, "with all else in the model it is no more than chance", watch, |own| {
            own.adjusted_p >= level
        })
    }

    /// Takes back effects as improbable as which synthetic data without an effect have them too.
    pub fn confirm(
        &mut self,
        grown: Grown,
        null_sets: &NullSets,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Grown>, Error> {
        let level = self.setting.search.level;
        self.prune(
            grown,
            "synthetic data without any effect, searched in the same way, lead to one as often",
            watch,
            |own| null_data::probability(null_sets, own.p) >= level,
        )
    }

    /// By how much velocities held out become more probable with effects than without, and the standard error.
    pub fn likelihood_gain(&self, with: &Model, watch: &mut Watch<'_>) -> Result<Option<[f64; 2]>, Error> {
        Ok(gain(&self.by_base, &predictive(&self.setting, with, self.split, watch)?))
    }

    /// Takes back the effect with the largest p as long as it is chance.
    fn prune(
        &mut self,
        mut grown: Grown,
        reason: &'static str,
        watch: &mut Watch<'_>,
        is_chance: impl Fn(&Tested) -> bool,
    ) -> Result<Option<Grown>, Error> {
        loop {
            let weakest = grown.tested.iter().max_by(|a, b| a.p.total_cmp(&b.p));
            let Some(candidate) = weakest.filter(|own| is_chance(own)).map(|own| own.candidate) else {
                return Ok(Some(grown));
            };
            self.refuse(candidate, reason);
            let kept: Vec<usize> =
                grown.model.added.iter().copied().filter(|own| *own != candidate).collect();
            if kept.is_empty() {
                return Ok(None);
            }
            grown = self.tested(self.setting.fit(kept, watch)?, watch)?;
        }
    }

    fn tested(&self, model: Model, watch: &mut Watch<'_>) -> Result<Grown, Error> {
        let tested = without_each(&self.setting, self.base, &model, watch)?;
        Ok(Grown { model, tested })
    }

    fn refuse(&mut self, candidate: usize, reason: &'static str) {
        self.ranking.refuse(self.setting.candidates[candidate].effect, reason);
    }
}

/// How probable a model makes velocities held out.
fn predictive(
    setting: &Setting<'_>,
    model: &Model,
    split: &Split,
    watch: &mut Watch<'_>,
) -> Result<Option<Predictive>, Error> {
    Predictive::new(&model.objective(setting.frames), &model.point(setting.frames), split, watch)
}

fn gain(before: &Option<Predictive>, after: &Option<Predictive>) -> Option<[f64; 2]> {
    before.as_ref().zip(after.as_ref()).map(|(before, after)| before.gain(after))
}
