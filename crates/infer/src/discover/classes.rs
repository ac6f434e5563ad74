//! What was added, with all that is known of it: what it explains, and what could stand in its place.

use super::crawling::Crawling;
use super::heterogeneity::Heterogeneity;
use super::lineup::added_places;
use super::resilience::partial;
use super::result::Selected;
use super::steps::{LEAD, Model, Setting};
use super::tested::Tested;
use crate::search::Watch;
use crate::{Error, FitParameter};
use voronudge_model::Effect;

/// Lead of the linear problem below which it is refitted to know.
const UNSURE: f64 = 25.0;

/// The effects added.
#[derive(Debug, Clone, Default)]
pub(super) struct Selection {
    pub selected: Vec<Selected>,
    /// Share of what the base model lacks beyond noise that they explain together.
    pub share: f64,
    /// The largest share that is compatible with chance.
    pub largest_share: f64,
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
