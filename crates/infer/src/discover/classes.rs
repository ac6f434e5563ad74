//! What was added against everything that could stand in its place.

use super::chance::Chance;
use super::crawling::{Crawling, TOO_LITTLE, is_too_little};
use super::heterogeneity::Heterogeneity;
use super::lineup::added_places;
use super::resilience::{Member, partial};
use super::result::Selected;
use super::steps::{Model, Setting};
use crate::search::Watch;
use crate::{Error, FitParameter};
use voronudge_model::Effect;

/// Lead in `−2 log L` below which another effect could as well be the right one: under it, so large a lead of a wrong one has a
/// probability below `exp(−lead/2)`, 5 %.
pub(super) const LEAD: f64 = 6.0;

/// Lead of the linear problem below which it is refitted to know.
const UNSURE: f64 = 25.0;

/// Least statistic that fitted coefficients are expected to have, as a share of the one found, which is that of the linear problem without them. A
/// third of the coefficients has a ninth.
const BORNE_OUT: f64 = 0.1;

/// Why an effect is taken back whose fit knows nothing of it.
const NOT_THERE: &str =
    "what speaks for it in the linear problem is not borne out: fitted with all else, it is hardly there";

/// The effects added.
#[derive(Debug, Clone, Default)]
pub(super) struct Selection {
    pub selected: Vec<Selected>,
    /// Share of what the base model lacks beyond noise that they explain together.
    pub share: f64,
    /// The largest share that is compatible with chance.
    pub largest_share: f64,
}

/// One effect added, tested with all others in the model.
pub(super) struct Tested {
    pub candidate: usize,
    pub p: f64,
    pub adjusted_p: f64,
    pub(super) statistic: f64,
    pub(super) size: f64,
    /// Why it does not stand without some of the data, if it does not.
    pub(super) weakness: Option<&'static str>,
    /// Other candidates in its place: lead over them in the linear problem, and their coefficients.
    pub(super) others: Vec<(usize, f64, Vec<f64>)>,
}

impl Tested {
    /// Why it is taken back at a level, if it is.
    pub fn reason_against(&self, level: f64) -> Option<&'static str> {
        match self.adjusted_p >= level {
            true => Some("with all else in the model it is no more than chance"),
            false => self.weakness,
        }
    }
}

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

/// The effects added with all that is known of them, and the parameters in which cells differ beside them.
pub(super) fn selection(
    setting: &Setting<'_>,
    base: &Model,
    (model, tested): (&Model, &[Tested]),
    differing: Option<&Heterogeneity>,
    watch: &mut Watch<'_>,
) -> Result<Selection, Error> {
    let places = added_places(&setting.search.fit.structure, setting.candidates, &model.added);
    let last = differing.map_or(model, |own| &own.model);
    let excess = Excess::new(setting, base, last, watch)?;
    let mut selected = Vec::with_capacity(tested.len());
    for (tested, places) in tested.iter().zip(&places.effects) {
        let candidate = &setting.candidates[tested.candidate];
        selected.push(Selected {
            effect: candidate.effect,
            columns: candidate.columns.clone().unwrap_or_default(),
            coefficients: match Crawling::of(setting, tested.candidate, model) {
                Some(crawling) => crawling.estimates(),
                None => {
                    places.iter().map(|k| model.inference.effects[k - FitParameter::COEFFICIENTS]).collect()
                }
            },
            adjusted_p: tested.adjusted_p,
            share_of_excess: (tested.statistic / excess.before).clamp(0.0, 1.0),
            size: tested.size,
            class: class(setting, model, tested, watch)?,
            partial: partial(setting, model, places)?,
        });
    }
    let share = excess.share(0.0);
    if setting.movie.is_some() {
        // Their noise is that of the model without the effects: it tells shares of each other, not of all.
        let sum: f64 = tested.iter().map(|own| own.statistic).sum();
        for (own, tested) in selected.iter_mut().zip(tested) {
            own.share_of_excess = share * tested.statistic / sum.max(f64::MIN_POSITIVE);
        }
    }
    if let Some(differing) = differing {
        let explained: f64 = selected.iter().map(|own: &Selected| own.share_of_excess).sum();
        selected.extend(differing.selected(setting, (share - explained).max(0.0))?);
    }
    Ok(Selection { selected, share, largest_share: excess.share(1.645) })
}

/// Effects that could as well stand in the place of one that was added.
fn class(
    setting: &Setting<'_>,
    model: &Model,
    tested: &Tested,
    watch: &mut Watch<'_>,
) -> Result<Vec<&'static Effect>, Error> {
    let mut rivals: Vec<&(usize, f64, Vec<f64>)> =
        tested.others.iter().filter(|own| own.1 < UNSURE).collect();
    rivals.sort_by(|a, b| a.1.total_cmp(&b.1));
    let kept: Vec<usize> = model.added.iter().copied().filter(|k| *k != tested.candidate).collect();
    let price = |k: usize| setting.price(&model.lineup, model.lineup.group(k).len());
    let mine = model.inference.objective + price(tested.candidate);
    let leads = watch.each("classes", &rivals, 1.0, |(candidate, lead, coefficients)| {
        // The columns of a response depend on all else in the model: only a refit tells.
        if setting.is_large() && setting.candidates[*candidate].is_linear() {
            return Ok(*lead);
        }
        let new = Some((*candidate, coefficients.as_slice()));
        let value = setting.refined(model, model.inference.noise, &kept, new)?;
        Ok(value + price(*candidate) - mine)
    })?;
    let close = rivals.iter().zip(leads).filter(|(_, lead)| *lead < LEAD);
    Ok(close.map(|((candidate, ..), _)| setting.candidates[*candidate].effect).collect())
}

/// What the base model lacks beyond noise, at the noise levels of the model with the effects.
struct Excess {
    before: f64,
    after: f64,
    deviation: f64,
}

impl Excess {
    fn new(setting: &Setting<'_>, base: &Model, model: &Model, watch: &mut Watch<'_>) -> Result<Self, Error> {
        let before =
            setting.at_levels(base, model.inference.noise, watch)? - base.inference.expected_objective;
        let after = model.inference.objective - model.inference.expected_objective;
        let deviation = (2.0 * model.inference.expected_objective).sqrt();
        Ok(Self { before: before.max(before - after).max(f64::MIN_POSITIVE), after, deviation })
    }

    /// The share explained, with what is left smaller by so many standard deviations.
    fn share(&self, deviations: f64) -> f64 {
        (1.0 - (self.after - deviations * self.deviation).max(0.0) / self.before).clamp(0.0, 1.0)
    }
}
