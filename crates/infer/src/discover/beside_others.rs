//! Each effect that was added, tested with all others in the model.

use super::chance::Chance;
use super::crawling::{Crawling, TOO_LITTLE, is_too_little};
use super::lineup::added_places;
use super::resilience::Member;
use super::steps::{Model, Setting};
use super::tested::Tested;
use crate::Error;
use crate::search::Watch;

/// Least statistic that fitted coefficients are expected to have, as a share of the one found, which is that of the linear problem without them. A
/// third of the coefficients has a ninth.
const BORNE_OUT: f64 = 0.1;

/// Why an effect is taken back whose fit knows nothing of it.
const NOT_THERE: &str =
    "what speaks for it in the linear problem is not borne out: fitted with all else, it is hardly there";

/// Tests each effect added, with all others in the model.
pub(super) fn without_each(
    setting: &Setting<'_>,
    base: &Model,
    model: &Model,
    watch: &mut Watch<'_>,
) -> Result<Vec<Tested>, Error> {
    let places = added_places(&setting.search.fit.structure, setting.candidates, &model.added);
    let mut all = Vec::with_capacity(model.added.len());
    for (candidate, places) in model.added.iter().zip(&places.effects) {
        let others: Vec<usize> = model.added.iter().copied().filter(|k| k != candidate).collect();
        if let Some(crawling) = Crawling::of(setting, *candidate, model) {
            all.push(crawling.tested(setting, base, &others));
            continue;
        }
        let own: Vec<f64> = places.iter().map(|k| model.inference.coefficients[*k]).collect();
        let own_lineup;
        let lineup = if others.is_empty() {
            &base.lineup
        } else if setting.candidates[*candidate].is_linear() {
            own_lineup = model.lineup.restored(*candidate, &own);
            &own_lineup
        } else {
            // With a response in the model the columns of the terms are not their own: only a fit without it tells.
            own_lineup = setting.fit(others.clone(), Some(model), watch)?.lineup;
            &own_lineup
        };
        let projected = lineup.beyond(&others);
        let on_offer = setting.named(&others);
        let chance = Chance::new(&projected, &on_offer, setting.search.fit.seed);
        let score = projected.score(*candidate);
        let worth = |statistic: f64, dimension: usize| statistic - setting.price(lineup, dimension);
        let mine = worth(score.statistic, score.dimension);
        // What another explains is measured with the same noise.
        let unit = score.statistic / projected.gain(*candidate).max(f64::MIN_POSITIVE);
        let rivals = on_offer.iter().filter(|k| *k != candidate).filter_map(|k| {
            let other = projected.score(*k);
            // What has no columns cannot stand in its place here.
            (other.dimension > 0).then(|| {
                (
                    *k,
                    mine - worth(projected.gain(*k) * unit, other.dimension),
                    other.coefficients.as_slice().to_vec(),
                )
            })
        });
        let member = Member { candidate: *candidate, places, others: &others, statistic: score.statistic };
        let adjusted_p = chance.adjusted(score.p);
        let is_there = projected.expected(*candidate, &own, &score) >= BORNE_OUT * score.statistic;
        all.push(Tested {
            candidate: *candidate,
            // What is no more than chance need not be looked at.
            weakness: match adjusted_p < setting.level(others.len()) {
                true if !is_there => Some(NOT_THERE),
                true if is_too_little(model, score.statistic) => Some(TOO_LITTLE),
                true => member.weakness(setting, base, model)?,
                false => None,
            },
            p: score.p,
            adjusted_p,
            statistic: score.statistic,
            size: score.size,
            others: rivals.collect(),
        });
    }
    Ok(all)
}
