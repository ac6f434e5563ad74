//! What a search for missing effects answers.

use crate::cross_validation::Folds;
use crate::diagnostics::Diagnostics;
use crate::{Doubt, Error, Estimate, Inference, Prospects, Tracked};
use voronudge_model::{Column, Effect};

/// The answer in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The base model explains the data within noise.
    NothingMissing,
    /// An effect, or a class of effects that the data cannot tell apart, explains what the base model lacks.
    Attributed,
    /// An effect explains a part, or predicts nothing better.
    Partial,
    /// Something with a structure in space or time is missing that no effect of the catalogue explains.
    UnexplainedStructured,
    /// There is more scatter than noise explains, without structure.
    UnexplainedWhite,
    /// The data are too few to tell.
    NotTestable,
}

/// A share of the squared velocities with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// `Σ‖v − v̂‖² / Σ‖v‖²` over velocities that the fit has not seen, at the measured positions.
    pub value: f64,
    /// Its standard error over folds.
    pub standard_error: f64,
    /// Number of folds.
    pub folds: usize,
    /// What is held out together.
    pub unit: HeldOutUnit,
}

impl HeldOut {
    pub(super) fn of(folds: &Folds) -> Self {
        let [value, standard_error] = folds.error();
        let unit = if folds.of_frames { HeldOutUnit::Frames } else { HeldOutUnit::Blocks };
        Self { value, standard_error, folds: folds.count(), unit }
    }
}

/// What is held out together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldOutUnit {
    /// Whole frames.
    Frames,
    /// Contiguous blocks of cells.
    Blocks,
}

/// What the squared velocities are made of, as shares of their sum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Budget {
    /// Errors of the positions.
    pub position_noise: f64,
    /// Errors of the velocities.
    pub velocity_noise: f64,
    /// The base model.
    pub base: f64,
    /// Effects added.
    pub effects: f64,
    /// The rest.
    pub unexplained: f64,
}

/// One model with what it leaves.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The fit.
    pub inference: Inference,
    /// Its error on velocities held out; none if they are too few.
    pub held_out: Option<HeldOut>,
    /// What the squared velocities are made of.
    pub budget: Budget,
    /// Of tracks: what their fit found beside.
    pub tracked: Option<Tracked>,
    /// The whitened residual: of unit variance and without correlations if nothing is missing. One entry per target. Of tracks: what their
    /// motions differ by from those seen, of unit variance, correlated by the errors of positions that they share.
    pub residuals: Vec<Vec<nalgebra::Vector2<f64>>>,
    /// What the whitened residual looks like.
    pub diagnostics: Diagnostics,
}

impl Fitted {
    /// What of the measurement is in doubt beside it.
    pub(super) fn doubt_of_measurement(&self) -> Option<&Doubt> {
        self.inference.doubts.iter().find(|doubt| doubt.part().is_measurement())
    }
}

/// An effect that was added.
#[derive(Debug, Clone)]
pub struct Selected {
    /// The effect.
    pub effect: &'static Effect,
    /// Its columns, in the order of `coefficients`.
    pub columns: Vec<Column>,
    /// Its coefficients, scaled as the data are.
    pub coefficients: Vec<Estimate>,
    /// Probability of so small a p of any candidate if nothing is missing.
    pub adjusted_p: f64,
    /// Share of what the model without it lacks beyond noise that it explains.
    pub share_of_excess: f64,
    /// Root mean square velocity that it adds, relative to that of the data.
    pub size: f64,
    /// Other effects that the data cannot tell from it.
    pub class: Vec<&'static Effect>,
    /// What it predicts beyond the other terms, and what they leave, for each target of each frame: prediction, residual.
    pub partial: Vec<[nalgebra::Vector2<f64>; 2]>,
}

/// What became of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub enum Fate {
    /// It was added.
    Selected,
    /// It cannot be told from the effect of this id, which was added.
    Alias(&'static str),
    /// Whatever it says, the parameters of the model say too.
    Absorbed,
    /// It is no more than chance.
    BelowThreshold,
    /// It was as good as others at first, but explains nothing beyond those added.
    Explained,
    /// It was better than chance, but fails one of the further conditions.
    NotConfirmed(&'static str),
    /// It was better than chance, but no fit with it comes to an end.
    NotFitted(Error),
    /// The data do not allow to test it.
    NotTestable(&'static str),
    /// A description, which is no cause.
    Description,
}

/// One candidate against the base model.
#[derive(Debug, Clone)]
pub struct Ranked {
    /// The effect.
    pub effect: &'static Effect,
    /// Number of coefficients that the data determine.
    pub dimension: usize,
    /// Score statistic, χ² with `dimension` degrees of freedom if nothing is missing.
    pub statistic: f64,
    /// Probability of a larger statistic.
    pub p: f64,
    /// Probability of so small a p of any candidate.
    pub adjusted_p: f64,
    /// Root mean square velocity, relative to that of the data, that would be found in 9 of 10 cases.
    pub detection_limit: f64,
    /// Estimate of the root mean square velocity when added alone, relative to that of the data.
    pub size: f64,
    /// 95 % interval of the size, for a single coefficient.
    pub interval: Option<[f64; 2]>,
    /// What became of it.
    pub fate: Fate,
}

/// A generic description of what the base model lacks.
#[derive(Debug, Clone)]
pub struct Described {
    /// The description.
    pub effect: &'static Effect,
    /// Number of its coefficients.
    pub dimension: usize,
    /// The fit.
    pub inference: Inference,
    /// Its error on velocities held out.
    pub held_out: Option<HeldOut>,
}

/// Synthetic data without an effect, fitted and searched like the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NullSets {
    /// Smallest p of any candidate in each set, ascending.
    pub smallest_p: Vec<f64>,
    /// Seeds of the sets.
    pub seeds: Vec<u64>,
}

/// The result of [`discover`](crate::discover).
#[derive(Debug, Clone)]
pub struct Discovery {
    /// The answer.
    pub verdict: Verdict,
    /// The base model.
    pub before: Fitted,
    /// The model with the effects added; the same as before if there are none.
    pub after: Fitted,
    /// Whether what the last model leaves has a structure.
    pub rest_is_structured: bool,
    /// The effects added, in the order of their selection.
    pub selected: Vec<Selected>,
    /// Every candidate, the smallest p first.
    pub ranking: Vec<Ranked>,
    /// A generic description in place of the effects, if one is better than chance.
    pub description: Option<Described>,
    /// Fall of the held-out error by the effects, and its standard error over folds (of the differences).
    pub gain: Option<[f64; 2]>,
    /// By how much the effects lower `−2 log p` of velocities held out, given all others, and its standard error.
    pub likelihood_gain: Option<[f64; 2]>,
    /// Share of what the base model lacks beyond noise that the effects explain.
    pub share_of_excess: f64,
    /// p that a single candidate needs, so that any of them is reached by chance with the probability asked for.
    pub single_p: f64,
    /// Synthetic data without an effect.
    pub null_sets: NullSets,
    /// What would be known of the last model, and could be told apart, if more, or better, had been measured.
    pub prospects: Option<Prospects>,
}

impl Discovery {
    /// What of the measurement is in doubt beside the last model.
    pub fn doubt_of_measurement(&self) -> Option<&Doubt> {
        self.after.doubt_of_measurement()
    }

    /// The effects added that act on all cells alike.
    pub fn shared(&self) -> impl Iterator<Item = &Selected> {
        self.selected.iter().filter(|own| own.effect.differing_parameter().is_none())
    }

    /// Whether single cells have something of their own.
    pub fn cells_differ(&self) -> bool {
        self.shared().count() < self.selected.len()
    }

    /// Whether the effects predict data held out better, by more than the standard error of the difference.
    pub fn predicts_better(&self) -> bool {
        self.gain.is_some_and(predicts_better)
    }
}

/// Whether the error on data held out falls by more than its standard error: a fit can only get better, a prediction need not.
pub(super) fn predicts_better(gain: [f64; 2]) -> bool {
    gain[0] > gain[1]
}
