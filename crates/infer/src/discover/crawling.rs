//! The polarity of cells as a candidate, and what turns it: states of the cells instead of columns.

use super::lineup::{critical_chi_squared, upper_chi_squared};
use super::ranking::{self, by_evidence};
use super::result::{Fate, Ranked};
use super::steps::{Model, Setting};
use super::tested::Tested;
use crate::Estimate;
use crate::tracks::{Alignment, Drive, Polarity};

/// Least evidence of what is found beside a polarity, or turns it, as a share of that of both together. How polarities turn is a model of the
/// simplest kind, and less than this is what it may be wrong by.
const LEAST_SHARE: f64 = 0.01;
pub(super) const TOO_LITTLE: &str = "it explains less than a hundredth of what the polarity does, whose own form is not known as well as that";

/// Coefficients of a polarity: its speed and how fast it is forgotten; of what turns it: one.
fn coefficients(setting: &Setting<'_>, candidate: usize) -> usize {
    if setting.candidates[candidate].turns_polarity() { 1 } else { 2 }
}

/// In the ranking, by its evidence alone.
fn ranked(setting: &Setting<'_>, candidate: usize, evidence: f64) -> Ranked {
    let dimension = coefficients(setting, candidate);
    by_evidence(setting, candidate, (evidence, dimension, p(evidence, dimension)))
}

/// What is no more than a hint beside a model, in the ranking: explained, if a fit of it may find more than what is refused.
pub(super) fn hinted(setting: &Setting<'_>, (candidate, hint): (usize, f64), model: &Model) -> Ranked {
    let mut ranked = ranked(setting, candidate, hint);
    // Of drives the score, which is about what their fit finds; of others that of a few points, which is the least.
    let is_too_little = setting.candidates[candidate].drives().any() && is_too_little(model, hint);
    if is_too_little && ranked.fate == Fate::Explained {
        ranked.fate = Fate::NotConfirmed(TOO_LITTLE);
    }
    ranked
}

/// The polarity of a fitted model, if it has one.
fn polarity(model: &Model) -> Option<&Polarity> {
    model.followed.as_ref()?.tracked.polarity.as_ref()
}

/// Whether something with so much evidence explains too little beside the polarity of a model, if that has one.
pub(super) fn is_too_little(model: &Model, evidence: f64) -> bool {
    polarity(model).is_some_and(|own| is_little(evidence, own))
}

fn is_little(evidence: f64, beside: &Polarity) -> bool {
    evidence < LEAST_SHARE * (beside.evidence + evidence)
}

/// Probability of so much evidence if there is none. Its speed, or the rate at which it aligns, is then at its bound, and the rate at which
/// it is forgotten means nothing: there are fewer degrees of freedom than coefficients.
pub(super) fn p(evidence: f64, coefficients: usize) -> f64 {
    upper_chi_squared(evidence, coefficients as f64)
}

/// The evidence that is needed beside so many other effects.
pub(super) fn least_evidence(setting: &Setting<'_>, candidate: usize, others: usize) -> f64 {
    let level = setting.level(others) / setting.named(&[]).len() as f64;
    critical_chi_squared(level, coefficients(setting, candidate) as f64)
}

/// The same for any of all candidates.
fn adjusted_p(setting: &Setting<'_>, candidate: usize, evidence: f64) -> f64 {
    ranking::adjusted_p(setting, p(evidence, coefficients(setting, candidate)))
}

/// What turns a polarity.
#[derive(Clone, Copy)]
struct Turn {
    value: f64,
    interval: [f64; 2],
    evidence: f64,
}

/// The polarity in a fitted model, or what turns it.
pub(super) struct Crawling<'a> {
    candidate: usize,
    polarity: &'a Polarity,
    /// What turns it, if that is what the candidate is.
    turn: Option<Turn>,
    /// Root mean square of the velocities.
    usual: f64,
}

impl<'a> Crawling<'a> {
    /// If a candidate is the polarity, and the model has one.
    pub fn of(setting: &Setting<'_>, candidate: usize, model: &'a Model) -> Option<Self> {
        let polarity = polarity(model)?;
        let inference = &model.inference;
        let own = &setting.candidates[candidate];
        let drives = own.drives();
        let drive = match drives.contact_inhibition {
            true => polarity.contact_inhibition,
            false => polarity.velocity_alignment.filter(|_| drives.velocity_alignment),
        };
        let driven = drive.map(|Drive { value, interval, evidence }| Turn { value, interval, evidence });
        let aligned = polarity.alignment.filter(|_| own.is_alignment());
        let turn = driven.or(aligned.map(|Alignment { rate, interval, evidence, .. }| Turn {
            value: rate,
            interval,
            evidence,
        }));
        (own.is_polarity() || turn.is_some()).then(|| Self {
            candidate,
            polarity,
            turn,
            usual: (inference.total / inference.used as f64).sqrt(),
        })
    }

    /// Why it is none beside so many other effects, if it is a polarity that is forgotten within an interval as far as these tracks can tell,
    /// or turns one too little.
    pub fn reason_against(&self, setting: &Setting<'_>, others: usize) -> Option<&'static str> {
        if let Some(Turn { evidence, .. }) = self.turn {
            return is_little(evidence, self.polarity).then_some(TOO_LITTLE);
        }
        let level = setting.level(others) / setting.named(&[]).len() as f64;
        let lasts = self.polarity.evidence_of_memory >= critical_chi_squared(level, 1.0);
        (!lasts).then_some(
            "it is forgotten within an interval, as far as these tracks can tell: that is random motion",
        )
    }

    /// By how much −2 log L falls with it.
    fn evidence(&self) -> f64 {
        self.turn.map_or(self.polarity.evidence, |own| own.evidence)
    }

    /// With all else in the model; `others` are the other candidates in it.
    pub fn tested(&self, setting: &Setting<'_>, base: &Model, others: &[usize]) -> Tested {
        let lineup = &base.lineup;
        let worth = |statistic: f64, dimension: usize| statistic - setting.price(lineup, dimension);
        let dimension = coefficients(setting, self.candidate);
        let mine = worth(self.evidence(), dimension);
        let projected = lineup.beyond(&[]);
        // Beside others only a fit of them without it would tell.
        let rivals = if others.is_empty() { setting.named(&[self.candidate]) } else { Vec::new() };
        let rivals = rivals.into_iter().map(|k| {
            let other = projected.score(k);
            (k, mine - worth(other.statistic, other.dimension), other.coefficients.as_slice().to_vec())
        });
        Tested {
            candidate: self.candidate,
            p: p(self.evidence(), dimension),
            adjusted_p: adjusted_p(setting, self.candidate, self.evidence()),
            weakness: self.reason_against(setting, others.len()),
            statistic: self.evidence(),
            size: self.size(),
            others: rivals.collect(),
        }
    }

    /// Relative to the velocities; of what turns a polarity not known.
    fn size(&self) -> f64 {
        if self.turn.is_some() { f64::NAN } else { self.polarity.speed / self.usual }
    }

    /// In the ranking.
    pub fn ranked(&self, setting: &Setting<'_>) -> Ranked {
        let plain = ranked(setting, self.candidate, self.evidence());
        if self.turn.is_some() {
            return plain;
        }
        let [least, most] = self.polarity.speed_interval.map(|end| end / self.usual);
        Ranked { detection_limit: most - least, size: self.size(), interval: Some([least, most]), ..plain }
    }

    /// Speed and rate, or the coefficient of what turns it.
    pub fn estimates(&self) -> Vec<Estimate> {
        if let Some(Turn { value, interval, .. }) = self.turn {
            return vec![Estimate {
                value,
                standard_error: 0.5 * (interval[1] - interval[0]) / 1.96,
                interval: interval.map(Some),
            }];
        }
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
