//! Every candidate against the base model, and what became of it.

use super::chance::Chance;
use super::classes::Selection;
use super::lineup::Lineup;
use super::result::{Fate, Ranked};
use super::steps::Setting;

/// All candidates, the smallest p first; those that cannot be tested at the end.
pub(super) fn rank(setting: &Setting<'_>, lineup: &Lineup) -> Vec<Ranked> {
    let projected = lineup.beyond(&[]);
    let chance = Chance::new(&projected, &setting.named(&[]), setting.search.fit.seed);
    let single_p = chance.single_p(setting.search.level);
    let mut ranking: Vec<Ranked> = setting
        .candidates
        .iter()
        .enumerate()
        .map(|(k, candidate)| {
            let effect = candidate.effect;
            if let Err(reason) = candidate.columns {
                return untested(effect, Fate::NotTestable(reason));
            }
            let score = projected.score(k);
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
        })
        .collect();
    let key = |ranked: &Ranked| (ranked.p, -ranked.statistic / ranked.dimension.max(1) as f64);
    ranking.sort_by(|a, b| {
        let ((p, s), (q, t)) = (key(a), key(b));
        p.total_cmp(&q).then(s.total_cmp(&t))
    });
    ranking
}

fn untested(effect: &'static voronudge_model::Effect, fate: Fate) -> Ranked {
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

/// The p that a single candidate needs against the base model.
pub(super) fn single_p(setting: &Setting<'_>, lineup: &Lineup) -> f64 {
    let projected = lineup.beyond(&[]);
    Chance::new(&projected, &setting.named(&[]), setting.search.fit.seed).single_p(setting.search.level)
}

/// Marks candidates that were added and then refused.
pub(super) fn refuse(ranking: &mut [Ranked], setting: &Setting<'_>, added: &[usize], reason: &'static str) {
    let ids: Vec<&str> = added.iter().map(|k| setting.candidates[*k].effect.id).collect();
    for ranked in ranking.iter_mut().filter(|ranked| ids.contains(&ranked.effect.id)) {
        ranked.fate = Fate::NotConfirmed(reason);
    }
}

/// Marks those selected and those that cannot be told from them. Where nothing was selected, what was better than chance at
/// first has not been confirmed.
pub(super) fn settle(ranking: &mut [Ranked], selection: &Selection) {
    for ranked in ranking {
        let same = |other: &&'static voronudge_model::Effect| other.id == ranked.effect.id;
        if selection.selected.iter().any(|own| own.effect.id == ranked.effect.id) {
            ranked.fate = Fate::Selected;
        } else if let Some(own) =
            selection.selected.iter().find(|own| own.class.iter().any(|other| same(&other)))
        {
            ranked.fate = Fate::Alias(own.effect.id);
        } else if selection.selected.is_empty() && ranked.fate == Fate::Explained {
            ranked.fate =
                Fate::NotConfirmed("it is not worth its coefficients, or went with one that was refused");
        }
    }
}
