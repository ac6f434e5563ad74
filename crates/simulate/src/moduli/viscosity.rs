//! Viscosities under shear back and forth.

use super::average::{Averages, STRIDE};
use super::deformation::parts;
use super::{Observer, Stop, stress_of};
use crate::{Driving, Error, Shear, Simulation};

/// Shear back and forth: the rate is `+ε` for half a period, then `−ε`. The defaults are the paper's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscosityProtocol {
    /// The rate `ε` (1/time).
    pub rate: f64,
    /// The period `T`.
    pub period: f64,
    /// Periods averaged over.
    pub periods: usize,
    /// Periods before these.
    pub transient_periods: usize,
    /// The time step; half a period is a whole number of steps of about this size.
    pub time_step: f64,
}

impl Default for ViscosityProtocol {
    fn default() -> Self {
        Self { rate: 0.01, period: 200.0, periods: 4, transient_periods: 1, time_step: 0.01 }
    }
}

/// Viscosities (area), with standard errors from blocks of the series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscosity {
    /// Shear viscosity `η = ⟨(σ_xy + σ_yx)/2 · sgn ė⟩/ε`.
    pub shear: f64,
    /// Its standard error.
    pub shear_error: f64,
    /// Odd shear viscosity `ηᵒ = ⟨(σ_xx − σ_yy)/2 · sgn ė⟩/ε`.
    pub odd_shear: f64,
    /// Its standard error.
    pub odd_shear_error: f64,
}

/// Viscosities in an affine solvent (paper, "Computation of the stress"): each cell is rubbed by a fluid that flows as
/// `ė(t) y x̂`, and the stress of the cells is averaged with the sign of the rate, `σ = ⟨σ(t) sgn ė⟩`.
///
/// The strain goes from 0 to `εT/2` and back. In a solid that does not yield the average is that of the elastic stress, which
/// vanishes only if the strain is symmetric about its rest; viscosities have a meaning in liquids.
///
/// # Errors
/// [`Error::Rate`] for a rate, period or number of periods that is not positive; [`Error::Interrupted`]; the errors of
/// [`Simulation::step`].
pub fn viscous(
    simulation: &Simulation,
    protocol: &ViscosityProtocol,
    stop: Stop<'_>,
) -> Result<Viscosity, Error> {
    let ViscosityProtocol { rate, period, periods, transient_periods, time_step } = *protocol;
    for (name, value) in [("shear rate", rate), ("period", period), ("number of periods", periods as f64)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::Rate { name, value });
        }
    }
    if !(time_step.is_finite() && time_step > 0.0) {
        return Err(Error::TimeStep { time_step });
    }
    let observer = Observer(stop);
    let half = ((0.5 * period / time_step).round() as usize).max(1);
    let time_step = 0.5 * period / half as f64;
    // The clock begins with the shear.
    let (positions, domain) = (simulation.positions().to_vec(), simulation.tessellation().domain());
    let mut sheared = Simulation::new(positions, domain, simulation.model().clone())?
        .with_driving(Driving { shear: Some(Shear::SquareWave { rate, period }), ..Driving::default() })?;
    let mut averages = Averages::default();
    for step in 1..=2 * half * (transient_periods + periods) {
        sheared.step(time_step)?;
        if step.is_multiple_of(10 * STRIDE) {
            observer.look()?;
        }
        if step > 2 * half * transient_periods && step.is_multiple_of(STRIDE) {
            let sign = if ((step - 1) / half).is_multiple_of(2) { 1.0 } else { -1.0 };
            averages.add(parts(stress_of(&sheared)).map(|part| part * sign / rate));
        }
    }
    let mean = averages.mean()?;
    Ok(Viscosity {
        shear: mean.parts[3],
        shear_error: mean.errors[3],
        odd_shear: mean.parts[2],
        odd_shear_error: mean.errors[2],
    })
}
