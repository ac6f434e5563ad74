//! What a fit says, in a word.

use crate::{Inference, NoiseSource, Part};

/// An objective this many times its expected value is no fit: the noise levels given, or the model, are wrong.
const UNACCEPTABLE: f64 = 3.0;

/// Velocities not seen whose error comes within its standard error of this are not predicted at all; one is the error of
/// predicting no motion.
const NOTHING: f64 = 0.95;

/// An error up to this many times that of the noise, and its standard error, is that of the noise: noise is known to some
/// per cent only.
const NOISE: f64 = 1.2;

/// The answer of a fit. The error on velocities that the fit has not seen decides; that of the fit itself always looks good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// What the model misses is what the noise of the measurement alone leaves.
    Explained,
    /// The model explains a part; the noise was estimated from the same fit, so what of the rest is noise cannot be told.
    ExplainedInPart,
    /// The model misses more than the noise.
    LacksSomething,
    /// The model predicts no better than no motion at all.
    ExplainsNothing,
    /// The data are not what the fit takes them for.
    MeasurementMisfit,
    /// The objective is more than three times its expected value.
    NoFit,
}

impl Inference {
    /// What the fit says. The first of these that holds: it explains nothing, it is no fit, the measurement is not what the fit
    /// takes it for, it explains what is not noise, or not all of it.
    pub fn verdict(&self) -> Verdict {
        let [held_out, spread] = self.nmse.cross_validated.unwrap_or([self.nmse.un_nudged, 0.0]);
        let floor = self.nmse.noise_floor;
        if held_out + spread >= NOTHING {
            return Verdict::ExplainsNothing;
        }
        if !self.is_acceptable() {
            return Verdict::NoFit;
        }
        if self.doubts.iter().any(|doubt| doubt.part().is_measurement()) {
            return Verdict::MeasurementMisfit;
        }
        let is_above = self.doubts.iter().any(|doubt| doubt.part() == Part::Objective);
        match self.noise_source {
            NoiseSource::Estimated => Verdict::ExplainedInPart,
            NoiseSource::Given if !is_above && held_out < NOISE * floor + spread => Verdict::Explained,
            NoiseSource::Given => Verdict::LacksSomething,
        }
    }

    /// Whether the objective is not far above its expected value.
    pub fn is_acceptable(&self) -> bool {
        self.objective <= UNACCEPTABLE * self.expected_objective
    }
}
