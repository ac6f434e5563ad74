//! The polarity of cells as a candidate: a state of each cell instead of a column.

use super::classes::Tested;
use super::lineup::upper_chi_squared;
use super::result::{Fate, Ranked};
use super::steps::{Model, Setting};
use crate::Estimate;
use crate::tracks::Polarity;

/// Coefficients of a polarity: its speed and how fast it is forgotten.
const COEFFICIENTS: usize = 2;

/// In the ranking, by its evidence alone, as before one is fitted.
pub(super) fn ranked(setting: &Setting<'_>, candidate: usize, evidence: f64) -> Ranked {
    let adjusted_p = adjusted_p(setting, evidence);
    Ranked {
        effect: setting.candidates[candidate].effect,
        dimension: COEFFICIENTS,
        statistic: evidence,
        p: p(evidence),
        adjusted_p,
        detection_limit: f64::NAN,
        size: f64::NAN,
        interval: None,
        fate: if adjusted_p >= setting.search.level { Fate::BelowThreshold } else { Fate::Explained },
    }
}

/// Probability of so much evidence if there is no polarity. Its rate of forgetting then means nothing and its speed is at its bound: two
/// degrees of freedom are more than there are.
fn p(evidence: f64) -> f64 {
    upper_chi_squared(evidence, COEFFICIENTS as f64)
}

/// The evidence that a polarity needs beside so many other effects: χ² with two degrees of freedom is above x with probability exp(−x/2).
pub(super) fn least_evidence(setting: &Setting<'_>, others: usize) -> f64 {
    2.0 * (setting.named(&[]).len() as f64 / setting.level(others)).ln()
}

/// The same for any of all candidates.
fn adjusted_p(setting: &Setting<'_>, evidence: f64) -> f64 {
    (p(evidence) * setting.named(&[]).len() as f64).min(1.0)
}

/// The polarity in a fitted model.
pub(super) struct Crawling<'a> {
    candidate: usize,
    polarity: &'a Polarity,
    /// Root mean square of the velocities.
    usual: f64,
}

impl<'a> Crawling<'a> {
    /// If a candidate is the polarity, and the model has one.
    pub fn of(setting: &Setting<'_>, candidate: usize, model: &'a Model) -> Option<Self> {
        let polarity = model.followed.as_ref()?.tracked.polarity.as_ref()?;
        let inference = &model.inference;
        setting.candidates[candidate].is_polarity().then(|| Self {
            candidate,
            polarity,
            usual: (inference.total / inference.used as f64).sqrt(),
        })
    }

    /// With all else in the model; `others` are the other candidates in it.
    pub fn tested(&self, setting: &Setting<'_>, base: &Model, others: &[usize]) -> Tested {
        let lineup = &base.lineup;
        let worth = |statistic: f64, dimension: usize| statistic - setting.price(lineup, dimension);
        let mine = worth(self.polarity.evidence, COEFFICIENTS);
        let projected = lineup.beyond(&[]);
        // Beside others only a fit of them without it would tell.
        let rivals = if others.is_empty() { setting.named(&[self.candidate]) } else { Vec::new() };
        let rivals = rivals.into_iter().map(|k| {
            let other = projected.score(k);
            (k, mine - worth(other.statistic, other.dimension), other.coefficients.as_slice().to_vec())
        });
        Tested {
            candidate: self.candidate,
            p: p(self.polarity.evidence),
            adjusted_p: adjusted_p(setting, self.polarity.evidence),
            weakness: None,
            statistic: self.polarity.evidence,
            size: self.polarity.speed / self.usual,
            others: rivals.collect(),
        }
    }

    /// In the ranking.
    pub fn ranked(&self, setting: &Setting<'_>) -> Ranked {
        let [least, most] = self.polarity.speed_interval.map(|end| end / self.usual);
        Ranked {
            detection_limit: most - least,
            size: self.polarity.speed / self.usual,
            interval: Some([least, most]),
            ..ranked(setting, self.candidate, self.polarity.evidence)
        }
    }

    /// Speed and rate.
    pub fn estimates(&self) -> Vec<Estimate> {
        let Polarity { speed, speed_interval, rate, rate_interval, .. } = self.polarity;
        let half = |ends: [f64; 2]| 0.5 * (ends[1] - ends[0]) / 1.96;
        let of_rate = rate_interval.map_or([Some(0.0), None], |ends| ends.map(Some));
        vec![
            Estimate {
                value: *speed,
                standard_error: half(*speed_interval),
                interval: speed_interval.map(Some),
            },
            Estimate {
                value: *rate,
                standard_error: rate_interval.map_or(f64::INFINITY, half),
                interval: of_rate,
            },
        ]
    }
}
