//! Random motion without a memory as a candidate: what the dynamics of tracks scatter by.
//!
//! It is asked last. The noise levels of every fit have it already, so that it stands in the place of nothing; and whatever else is missing
//! scatters too as long as it has no name. It is not asked of cells that crawl: their polarities turn within an interval, and where they
//! push each other through changes of contacts a fit ends with a scatter that is of the fit. Nor is it asked of centroids, whose errors neighbours share.

use super::crawling::p;
use super::ranking::{by_evidence, untested};
use super::resilience::partial;
use super::result::{Fate, Ranked, Selected};
use super::steps::{Model, Setting};
use crate::tracks::{Movie, Scatter};
use crate::{Activity, Error, Estimate};

/// Share of the root mean square velocity below which a scatter, or the lower end of its interval, has no name: an exact model leaves some where contacts change and at the rim of
/// a field (2.7 % of exact positions in an open field), whatever the likelihood says.
const LEAST_SIZE: f64 = 0.04;

/// Why it is then not named.
const NUMERICAL: &str =
    "below 4 % of the velocity it may be what following the cells through changes of contacts leaves";

/// Why it is no question of cells that crawl.
const BESIDE_POLARITY: &str =
    "beside a polarity it cannot be told from what turns and changes of contacts within an interval leave";

/// Why it is no question of centroids.
const OF_CENTROIDS: &str = "centroids of cells that have a side in common share its errors, which look like this and which no fit knows";

/// What a fit says of random motion.
pub(super) struct RandomMotion {
    pub ranked: Ranked,
    /// As an effect beside the others, if it is more than chance.
    pub selected: Option<Selected>,
}

impl RandomMotion {
    /// Of the last model, if it is a candidate and what the motions scatter by can be told.
    pub fn of(setting: &Setting<'_>, model: &Model) -> Result<Option<Self>, Error> {
        let is_it = |k: &usize| setting.candidates[*k].effect.is_random_motion();
        let Some(candidate) = setting.named(&model.added).into_iter().find(is_it) else { return Ok(None) };
        let effect = setting.candidates[candidate].effect;
        let of_centroids = setting.movie.is_some_and(|movie| movie.share() > 0.0).then_some(OF_CENTROIDS);
        let beside_polarity = (model.request.activity != Activity::None).then_some(BESIDE_POLARITY);
        if let Some(reason) = beside_polarity.or(of_centroids) {
            let ranked = untested(effect, Fate::NotTestable(reason));
            return Ok(Some(Self { ranked, selected: None }));
        }
        let Some(Scatter { diffusion, interval, evidence }) = setting.scatter(model)? else {
            return Ok(None);
        };
        let inference = &model.inference;
        let usual = (inference.total / inference.used as f64).sqrt();
        let time = setting.movie.map_or(1.0, Movie::interval);
        // Of the mean velocity over the usual interval.
        let size_of = |diffusion: f64| (4.0 * diffusion / time).sqrt() / usual;
        let (size, [least, most]) = (size_of(diffusion), interval.map(size_of));
        let plain = by_evidence(setting, candidate, (evidence, 1, p(evidence, 1)));
        let fate = match plain.fate {
            Fate::Explained if least < LEAST_SIZE => Fate::NotConfirmed(NUMERICAL),
            fate => fate,
        };
        let ranked =
            Ranked { size, interval: Some([least, most]), detection_limit: most - least, fate, ..plain };
        let is_chance = ranked.adjusted_p >= setting.level(model.added.len());
        if matches!(ranked.fate, Fate::NotConfirmed(_)) || is_chance {
            return Ok(Some(Self { ranked, selected: None }));
        }
        let selected = Selected {
            effect,
            columns: Vec::new(),
            coefficients: vec![Estimate {
                value: diffusion,
                standard_error: 0.5 * (interval[1] - interval[0]) / 1.96,
                interval: interval.map(Some),
            }],
            adjusted_p: ranked.adjusted_p,
            // Every model that is fitted has it.
            share_of_excess: 0.0,
            size,
            class: Vec::new(),
            partial: partial(setting, model, &[])?,
        };
        Ok(Some(Self { ranked, selected: Some(selected) }))
    }
}
