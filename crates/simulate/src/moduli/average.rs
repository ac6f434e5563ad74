//! The stress of a flowing tissue, averaged over time.

use super::{Flowing, Observer, stress_of};
use crate::{Error, Simulation};
use voronudge_observables::BlockAverage;

/// Steps from one look at the stress to the next: it costs a quarter of a step.
pub(super) const STRIDE: usize = 10;

/// Averages of the parts of a stress, and their standard errors.
pub(super) struct MeanStress {
    pub parts: [f64; 4],
    pub errors: [f64; 4],
}

/// Averages of several correlated series; errors of fewer than 16 values are infinite.
#[derive(Default)]
pub(super) struct Averages([BlockAverage; 4]);

impl Averages {
    pub fn add(&mut self, values: [f64; 4]) {
        self.0.iter_mut().zip(values).for_each(|(average, value)| average.add(value));
    }

    pub fn mean(&self) -> Result<MeanStress, Error> {
        if self.0[0].count() == 0 {
            return Err(Error::NoFrames);
        }
        let mean = |k: usize| self.0[k].mean().unwrap_or(0.0);
        let error = |k: usize| self.0[k].standard_error().unwrap_or(f64::INFINITY);
        Ok(MeanStress { parts: std::array::from_fn(mean), errors: std::array::from_fn(error) })
    }
}

/// The mean stress over a time after a transient.
pub(super) fn mean_stress(
    simulation: &mut Simulation,
    flowing: &Flowing,
    time_step: f64,
    in_parts: &(dyn Fn([[f64; 2]; 2]) -> [f64; 4] + Sync),
    observer: Observer<'_>,
) -> Result<MeanStress, Error> {
    let steps = |time: f64| (time / time_step).round() as usize;
    let (transient, all) = (steps(flowing.transient), steps(flowing.transient + flowing.time));
    let mut averages = Averages::default();
    for step in 0..all {
        simulation.step(time_step)?;
        if step.is_multiple_of(10 * STRIDE) {
            observer.look()?;
        }
        if step >= transient && (step - transient).is_multiple_of(STRIDE) {
            averages.add(in_parts(stress_of(simulation)));
        }
    }
    averages.mean()
}
