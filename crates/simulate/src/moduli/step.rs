//! The stress after a step strain, in time.

use super::deformation::{Deformation, Strain, parts};
use super::{Moduli, Motion, Observer, Relaxation, Settled, Stop, StressResponse, deformed, stress_of};
use crate::{Error, Simulation};
use rayon::prelude::*;

/// Moduli at some times after a small strain that all cells follow at once: first those without relaxation, and in the end those at
/// rest. None if the tissue does not come to rest before the strain.
///
/// Dilation and both shears of `±strain` are put on the tissue. `times` ascend; the time step is that of the relaxation.
///
/// # Errors
/// [`Error::Interrupted`], [`Error::OpenDomain`], and the errors of [`Simulation::step`].
pub fn after_a_step(
    simulation: &Simulation,
    relaxation: &Relaxation,
    strain: f64,
    times: &[f64],
    stop: Stop<'_>,
) -> Result<Option<Vec<Moduli>>, Error> {
    let observer = Observer(stop);
    let settled = Settled::new(simulation, relaxation, stop)?;
    if settled.motion() == Motion::Flowing {
        return Ok(None);
    }
    let jobs: Vec<_> =
        Strain::ALL.into_iter().flat_map(|own| [1.0, -1.0].map(|sign| (own, sign * strain))).collect();
    let series: Vec<Vec<[f64; 4]>> = jobs
        .par_iter()
        .map(|&(own, amount)| {
            let deformation = Deformation::new(own, amount);
            let mut tissue = deformed(settled.simulation(), &deformation)?;
            let mut made = 0;
            let at = |time: &f64| {
                let steps = (time / relaxation.time_step).round() as usize;
                while made < steps {
                    tissue.step(relaxation.time_step)?;
                    made += 1;
                }
                observer.look()?;
                Ok(parts(deformation.turn_back(stress_of(&tissue))))
            };
            times.iter().map(at).collect::<Result<_, Error>>()
        })
        .collect::<Result<_, Error>>()?;
    let at = |k: usize| {
        let response: StressResponse = std::array::from_fn(|part| {
            std::array::from_fn(|own| {
                (series[2 * own][k][part] - series[2 * own + 1][k][part]) / (2.0 * strain)
            })
        });
        Moduli::of(&response)
    };
    Ok(Some((0..times.len()).map(at).collect()))
}
