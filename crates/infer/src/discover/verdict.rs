//! The answer in a word.

use super::chance::Chance;
use super::result::{Fitted, Verdict};
use super::steps::{Model, Setting};
use crate::{Doubt, NoiseSource};

/// p below which what is left has a structure. It is small because every data set is tested.
const STRUCTURED: f64 = 0.003;

/// Share of the excess that effects must explain, chance allowed for, to be all that is missing.
const ENOUGH: f64 = 0.8;

/// What the last model leaves.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// A structure in space or time.
    pub structured: bool,
    /// More than noise explains.
    pub too_much: bool,
    /// How the cells were measured is in doubt.
    pub measurement: bool,
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
            measurement: fitted.doubt_of_measurement().is_some(),
        }
    }
}

/// The verdict. Of effects that were selected the share of the excess is given that they explain, chance allowed for; they are proven by
/// what they predict, unless nobody asked for that.
pub(super) fn decide(testable: bool, explained: Option<f64>, left: &Left, proven: bool) -> Verdict {
    match (explained, left) {
        (Some(share), Left { structured: false, too_much: false, measurement: false })
            if proven && share >= ENOUGH =>
        {
            Verdict::Attributed
        }
        (Some(_), _) => Verdict::Partial,
        _ if !testable => Verdict::NotTestable,
        (None, Left { structured: true, .. }) => Verdict::UnexplainedStructured,
        (None, Left { too_much: true, .. }) => Verdict::UnexplainedWhite,
        (None, _) => Verdict::NothingMissing,
    }
}

#[cfg(test)]
mod tests {
    use super::super::result::predicts_better;
    use super::*;

    /// An error of .0769 that becomes .0726 ± .0073 has not fallen.
    #[test]
    fn effects_that_predict_nothing_better_are_not_attributed() {
        let left = Left { structured: false, too_much: false, measurement: false };
        let of = |gain| decide(true, Some(0.95), &left, predicts_better(gain));
        assert_eq!(of([0.0043, 0.0073]), Verdict::Partial);
        assert_eq!(of([0.0143, 0.0073]), Verdict::Attributed);
        assert_eq!(decide(true, Some(0.7), &left, true), Verdict::Partial);
        let structured = Left { structured: true, ..left };
        assert_eq!(decide(true, Some(0.95), &structured, true), Verdict::Partial);
        let doubtful = Left { measurement: true, ..left };
        assert_eq!(decide(true, Some(0.95), &doubtful, true), Verdict::Partial);
        assert_eq!(decide(true, None, &doubtful, true), Verdict::NothingMissing);
        assert_eq!(decide(true, None, &structured, false), Verdict::UnexplainedStructured);
        assert_eq!(decide(true, None, &left, false), Verdict::NothingMissing);
    }
}
