//! Random motion without a memory as a candidate: what the dynamics of tracks scatter by.
//!
//! It is asked last. The noise levels of every fit have it already, so that it stands in the place of nothing; and whatever else is missing
//! scatters too as long as it has no name. It is not asked of cells that crawl: their polarities turn within an interval, and where they
//! push each other through changes of contacts a fit ends with a scatter that is of the fit.

use super::crawling::p;
use super::ranking::{by_evidence, untested};
use super::resilience::partial;
use super::result::{Fate, Ranked, Selected};
use super::steps::{Model, Setting};
use crate::tracks::{Movie, Scatter};
use crate::{Activity, Error, Estimate};

/// Share of the root mean square velocity below which a scatter has no name: an exact model leaves some where contacts change and at the rim of
/// a field (2.7 % of exact positions in an open field), whatever the likelihood says.
const LEAST_SIZE: f64 = 0.04;

/// Why it is then not named.
const NUMERICAL: &str =
    "below 4 % of the velocity it may be what following the cells through changes of contacts leaves";

/// Why it is no question of cells that crawl.
const BESIDE_POLARITY: &str =
    "beside a polarity it cannot be told from what turns and changes of contacts within an interval leave";

/// The scatter of a fit, tested.
pub(super) struct RandomMotion {
    candidate: usize,
    scatter: Option<Scatter>,
    pub ranked: Ranked,
}

impl RandomMotion {
    /// Of the last model, if it is a candidate and what the motions scatter by can be told.
    pub fn of(setting: &Setting<'_>, model: &Model) -> Result<Option<Self>, Error> {
        let is_it = |k: &usize| setting.candidates[*k].effect.is_random_motion();
        let Some(candidate) = setting.named(&model.added).into_iter().find(is_it) else { return Ok(None) };
        if model.request.activity != Activity::None {
            let ranked = untested(setting.candidates[candidate].effect, Fate::NotTestable(BESIDE_POLARITY));
            return Ok(Some(Self { candidate, scatter: None, ranked }));
        }
        let Some(scatter) = setting.scatter(model)? else { return Ok(None) };
        let inference = &model.inference;
        let usual = (inference.total / inference.used as f64).sqrt();
        let evidence = scatter.evidence;
        let plain = by_evidence(setting, candidate, (evidence, 1, p(evidence, 1)));
        let interval = setting.movie.map_or(1.0, Movie::interval);
        // Of the mean velocity over the usual interval.
        let size = |diffusion: f64| (4.0 * diffusion / interval).sqrt() / usual;
        let fate = match plain.fate {
            Fate::Explained if size(scatter.diffusion) < LEAST_SIZE => Fate::NotConfirmed(NUMERICAL),
            fate => fate,
        };
        let [least, most] = scatter.interval.map(size);
        let ranked = Ranked {
            size: size(scatter.diffusion),
            interval: Some([least, most]),
            detection_limit: most - least,
            fate,
            ..plain
        };
        Ok(Some(Self { candidate, scatter: Some(scatter), ranked }))
    }

    /// As an effect beside so many others, unless it is no more than chance.
    pub fn selected(&self, setting: &Setting<'_>, model: &Model) -> Result<Option<Selected>, Error> {
        let is_numerical = matches!(self.ranked.fate, Fate::NotConfirmed(_));
        if is_numerical || self.ranked.adjusted_p >= setting.level(model.added.len()) {
            return Ok(None);
        }
        let Some(Scatter { diffusion, interval, .. }) = self.scatter else { return Ok(None) };
        Ok(Some(Selected {
            effect: setting.candidates[self.candidate].effect,
            columns: Vec::new(),
            coefficients: vec![Estimate {
                value: diffusion,
                standard_error: 0.5 * (interval[1] - interval[0]) / 1.96,
                interval: interval.map(Some),
            }],
            adjusted_p: self.ranked.adjusted_p,
            // Every model that is fitted has it.
            share_of_excess: 0.0,
            size: self.ranked.size,
            class: Vec::new(),
            partial: partial(setting, model, &[])?,
        }))
    }
}
