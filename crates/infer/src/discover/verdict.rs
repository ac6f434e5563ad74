//! The answer in a word.

use super::chance::Chance;
use super::classes::Selection;
use super::result::{Fitted, Verdict};
use super::steps::{Model, Setting};
use crate::{Doubt, NoiseSource};

/// p below which what is left has a structure. It is small because every data set is tested.
const STRUCTURED: f64 = 0.003;

/// Share of the excess that effects must explain, chance allowed for, to be all that is missing.
const ENOUGH: f64 = 0.8;

/// Whether the error on data held out falls by more than its standard error: a fit can only get better, a prediction need not.
pub(super) fn predicts_better(gain: [f64; 2]) -> bool {
    gain[0] > gain[1]
}

/// What the last model leaves.
pub(super) struct Left {
    /// A structure in space or time.
    pub structured: bool,
    /// More than noise explains.
    pub too_much: bool,
}

impl Left {
    pub fn new(setting: &Setting<'_>, model: &Model, fitted: &Fitted) -> Self {
        let projected = model.lineup.beyond(&model.added);
        let descriptions = setting.descriptions();
        let smallest = descriptions.iter().map(|k| projected.score(*k).p).fold(1.0, f64::min);
        let chance = Chance::new(&projected, &descriptions, setting.search.fit.seed);
        let described = !descriptions.is_empty() && chance.adjusted(smallest) < STRUCTURED;
        let inference = &fitted.inference;
        Self {
            structured: described || fitted.diagnostics.structure.p < STRUCTURED,
            too_much: inference.noise_source == NoiseSource::Given
                && inference.doubts.iter().any(|doubt| matches!(doubt, Doubt::Objective(_))),
        }
    }
}

/// The verdict. Effects are proven by what they predict, unless nobody asked for that.
pub(super) fn decide(testable: bool, selection: &Selection, left: &Left, proven: bool) -> Verdict {
    match (selection.selected.is_empty(), left) {
        (false, Left { structured: false, too_much: false })
            if proven && selection.largest_share >= ENOUGH =>
        {
            Verdict::Attributed
        }
        (false, _) => Verdict::Partial,
        _ if !testable => Verdict::NotTestable,
        (true, Left { structured: true, .. }) => Verdict::UnexplainedStructured,
        (true, Left { too_much: true, .. }) => Verdict::UnexplainedWhite,
        (true, _) => Verdict::NothingMissing,
    }
}
