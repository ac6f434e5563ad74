//! What a fit says of drives of polarities, and what one without them says.

use super::likely::QUANTILE;
use super::memory::Memory;
use super::objective::MovieObjective;
use crate::normal_equations::NormalEquations;
use crate::{Drives, Error};
use nalgebra::DMatrix;

/// A drive of polarities, in the units of the movie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Its coefficient.
    pub value: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
    /// By how much −2 log L falls from none to this one, all else free, at the same noise levels and memory.
    pub evidence: f64,
}

/// By how much −2 log L would fall to first order with each drive that a fit lacks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct HintsOfDrives {
    pub contact_inhibition: f64,
    pub velocity_alignment: f64,
}

impl Memory {
    /// Which share of what drives a polarity over the usual interval is left of it at the end: (1 − e^{−x})/x.
    pub(crate) fn kept(self) -> f64 {
        -(-self.times).exp_m1() / self.times
    }
}

impl MovieObjective<'_> {
    /// Covariance of c_n and c_F, all else free.
    fn covariance_of_drives(&self, equations: &NormalEquations) -> Result<Option<DMatrix<f64>>, Error> {
        let Some(block) = self.states.polarities.of_drives() else { return Ok(None) };
        Ok(Some(equations.covariance_of(block)? * self.levels.velocity.powi(2)))
    }

    /// Contact inhibition and alignment with the velocity in a fit, as far as they were asked for.
    pub(super) fn drives_found(
        &self,
        equations: &NormalEquations,
        c: [f64; 2],
    ) -> Result<[Option<Drive>; 2], Error> {
        let (Some(memory), Some(covariance)) = (self.memory, self.covariance_of_drives(equations)?) else {
            return Ok([None; 2]);
        };
        let (interval, Drives { contact_inhibition, velocity_alignment }) =
            (self.movie.interval(), self.states.polarities.drives);
        let units = [interval.powi(2), interval].map(|unit| unit * memory.kept());
        let drive = |k: usize| {
            let error = covariance[(k, k)].max(0.0).sqrt();
            let ends = [-QUANTILE, QUANTILE].map(|quantile| (c[k] + quantile * error) / units[k]);
            Drive { value: c[k] / units[k], interval: ends, evidence: (c[k] / error).powi(2) }
        };
        Ok([contact_inhibition.then(|| drive(0)), velocity_alignment.then(|| drive(1))])
    }

    /// What speaks for each of both drives, of polarities that have `present` ones already and may have both: a test by the score. All else
    /// counts as being at its minimum, so that only what pulls at the drives themselves is asked.
    pub(super) fn hints_of_drives(
        &self,
        equations: &NormalEquations,
        present: Drives,
    ) -> Result<HintsOfDrives, Error> {
        let (Some(covariance), Some(block)) =
            (self.covariance_of_drives(equations)?, self.states.polarities.of_drives())
        else {
            return Ok(HintsOfDrives::default());
        };
        let pull = equations.pull_on(block)? / self.levels.velocity.powi(2);
        let (c, v) = (&covariance * pull, covariance);
        // Each beside the other if that is there, and alone if it is not.
        let of = |k: usize, other_is_present: bool| {
            let other = 1 - k;
            let (mut value, mut variance) = (c[k], v[(k, k)]);
            if !other_is_present {
                value -= v[(k, other)] / v[(other, other)] * c[other];
                variance -= v[(k, other)].powi(2) / v[(other, other)];
            }
            value.powi(2) / variance.max(f64::MIN_POSITIVE)
        };
        Ok(HintsOfDrives {
            contact_inhibition: if present.contact_inhibition {
                0.0
            } else {
                of(0, present.velocity_alignment)
            },
            velocity_alignment: if present.velocity_alignment {
                0.0
            } else {
                of(1, present.contact_inhibition)
            },
        })
    }
}
