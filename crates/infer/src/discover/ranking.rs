//! Every candidate against the base model, and what became of it.

use super::candidate::Candidate;
use super::chance::Chance;
use super::lineup::Lineup;
use super::result::{Fate, Ranked, Selected};
use super::steps::Setting;
use voronudge_model::Effect;

/// Why it is no question what turns polarities.
const NO_POLARITY: &str = "no polarity was found that could turn";

/// Why random motion is no question.
const NO_SCATTER: &str = "the motions are too few, or what they scatter by was given";

/// Why it was not asked whether cells differ, or anything else.
pub(super) const NOTHING_TO_TELL: &str = "the velocities are too few to tell";

/// Why nothing is asked of cells that turn around between frames.
pub(super) const TURNING: &str =
    "cells turn around between frames, and the paths that a fit finds need not be theirs";

/// All candidates, the smallest p first; those that cannot be tested at the end.
pub(super) struct Ranking {
    pub candidates: Vec<Ranked>,
    /// The p that a single candidate needs.
    pub single_p: f64,
}

impl Ranking {
    /// Scores beside the fit of a model that lacks all candidates with columns.
    pub fn new(setting: &Setting<'_>, lineup: &Lineup) -> Self {
        let projected = lineup.beyond(&[]);
        let chance = Chance::new(&projected, &setting.named(&[]), setting.search.fit.seed);
        let single_p = chance.single_p(setting.search.level);
        let rank = |(k, candidate): (usize, &Candidate)| {
            let effect = candidate.effect;
            if let Err(reason) = candidate.columns {
                return untested(effect, Fate::NotTestable(reason));
            }
            let score = projected.score(k);
            if candidate.turns_polarity() {
                return untested(effect, Fate::NotTestable(NO_POLARITY));
            }
            if candidate.effect.is_random_motion() {
                return untested(effect, Fate::NotTestable(NO_SCATTER));
            }
            if candidate.differing().is_some() {
                return untested(effect, Fate::NotTestable(NOTHING_TO_TELL));
            }
            if score.dimension == 0 {
                return untested(effect, Fate::Absorbed);
            }
            let adjusted_p = chance.adjusted(score.p);
            let fate = match () {
                () if !candidate.is_named() => Fate::Description,
                () if adjusted_p >= setting.search.level => Fate::BelowThreshold,
                () => Fate::Explained,
            };
            Ranked {
                effect,
                dimension: score.dimension,
                statistic: score.statistic,
                p: score.p,
                adjusted_p,
                detection_limit: score.detection_limit(single_p),
                size: score.size,
                interval: score.interval,
                fate,
            }
        };
        let mut candidates: Vec<Ranked> = setting.candidates.iter().enumerate().map(rank).collect();
        let per_coefficient = |ranked: &Ranked| ranked.statistic / ranked.dimension.max(1) as f64;
        candidates
            .sort_by(|a, b| a.p.total_cmp(&b.p).then(per_coefficient(b).total_cmp(&per_coefficient(a))));
        Self { candidates, single_p }
    }

    /// Scores beside another fit. What is known of states of the cells stays.
    pub fn renew(&mut self, setting: &Setting<'_>, lineup: &Lineup) {
        let known = std::mem::replace(self, Self::new(setting, lineup)).candidates;
        known
            .into_iter()
            .filter(|own| own.effect.is_of_polarity() && own.dimension > 0)
            .for_each(|own| self.put(own));
    }

    /// Puts in what is known of a candidate by another test than the score.
    pub fn put(&mut self, own: Ranked) {
        self.candidates.retain(|other| other.effect.id != own.effect.id);
        let place = self.candidates.partition_point(|other| other.p < own.p);
        self.candidates.insert(place, own);
    }

    /// Marks what became of a candidate that was tried.
    pub fn end(&mut self, effect: &Effect, fate: &Fate) {
        for ranked in self.candidates.iter_mut().filter(|ranked| ranked.effect.id == effect.id) {
            ranked.fate = fate.clone();
        }
    }

    /// Marks those that are better than chance where nothing is asked any further.
    pub fn leave(&mut self, reason: &'static str) {
        for ranked in self.candidates.iter_mut().filter(|ranked| ranked.fate == Fate::Explained) {
            ranked.fate = Fate::NotConfirmed(reason);
        }
    }

    /// Marks those selected and those that cannot be told from them. Where nothing was selected, what was better than
    /// chance at first has not been confirmed.
    pub fn settle(&mut self, selected: &[Selected]) {
        for ranked in &mut self.candidates {
            let is = |other: &Effect| other.id == ranked.effect.id;
            let fate = if let Some(own) = selected.iter().find(|own| is(own.effect)) {
                if ranked.size.is_nan() {
                    ranked.size = own.size;
                }
                Some(Fate::Selected)
            } else if let Some(own) = selected.iter().find(|own| own.class.iter().any(|other| is(other))) {
                Some(Fate::Alias(own.effect.id))
            } else if selected.is_empty() && ranked.fate == Fate::Explained {
                Some(Fate::NotConfirmed(
                    "it is not worth its coefficients, or less so than one that was refused",
                ))
            } else {
                None
            };
            if let Some(fate) = fate {
                ranked.fate = fate;
            }
        }
    }
}

/// The adjusted p of a test other than the score, of so many candidates.
pub(super) fn adjusted_p(setting: &Setting<'_>, p: f64) -> f64 {
    (p * setting.named(&[]).len() as f64).min(1.0)
}

/// A candidate that is tested by the fall of −2 log L, with the probability of so large a one.
pub(super) fn by_evidence(
    setting: &Setting<'_>,
    candidate: usize,
    (evidence, dimension, p): (f64, usize, f64),
) -> Ranked {
    let adjusted_p = adjusted_p(setting, p);
    Ranked {
        effect: setting.candidates[candidate].effect,
        dimension,
        statistic: evidence,
        p,
        adjusted_p,
        detection_limit: f64::NAN,
        size: f64::NAN,
        interval: None,
        fate: if adjusted_p >= setting.search.level { Fate::BelowThreshold } else { Fate::Explained },
    }
}

/// A candidate without numbers.
pub(super) fn untested(effect: &'static Effect, fate: Fate) -> Ranked {
    Ranked {
        effect,
        dimension: 0,
        statistic: 0.0,
        p: 1.0,
        adjusted_p: 1.0,
        detection_limit: f64::NAN,
        size: f64::NAN,
        interval: None,
        fate,
    }
}
