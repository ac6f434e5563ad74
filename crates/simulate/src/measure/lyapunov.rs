//! The largest Lyapunov exponent by tangent dynamics.

use crate::{Error, Simulation, generator};
use num_dual::Dual64;
use rand::Rng;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, Vector};
use voronudge_model::Model;
use voronudge_observables::BlockAverage;

/// How long a Lyapunov exponent is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LyapunovSchedule {
    /// The time step.
    pub time_step: f64,
    /// Steps before the growth is counted: the tangent vector turns to the fastest direction.
    pub transient: usize,
    /// Steps whose growth is counted.
    pub steps: usize,
    /// Steps between renormalisations: the tangent vector must not leave the range of numbers.
    pub renormalisation: usize,
}

impl LyapunovSchedule {
    /// A measurement over a time: a fifth of it lets the tangent vector turn, and it is renormalised every ten steps.
    ///
    /// ```
    /// use voronudge_simulate::measure::LyapunovSchedule;
    /// let schedule = LyapunovSchedule::over(10.0, 0.01);
    /// assert_eq!((schedule.transient, schedule.steps), (200, 800));
    /// ```
    pub fn over(time: f64, time_step: f64) -> Self {
        let steps = (time / time_step * (1.0 - 1e-12)).ceil().max(1.0) as usize;
        let transient = steps / 5;
        Self { time_step, transient, steps: steps - transient, renormalisation: 10 }
    }
}

/// The largest Lyapunov exponent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LyapunovExponent {
    /// The mean growth rate λ of the tangent vector, in 1/time.
    pub value: f64,
    /// Its standard error from blocks of the series of growth rates; `None` for fewer than 16 renormalisations.
    pub standard_error: Option<f64>,
}

/// The largest Lyapunov exponent of the trajectory from `positions` (N) in a periodic domain: the growth rate of a tangent
/// vector `δ̇ = J(r) δ` by exact Jacobian–vector products.
///
/// Positions and tangent vector are those of a [`Simulation`] of dual numbers, so the tangent
/// map is the exact derivative of the numerical step at frozen topology. Uniform translations, whose exponent is zero, are
/// taken out. At a T1 the tangent vector goes over unchanged: where the force jumps there, the contribution of the jump
/// itself is not in λ. One step costs about four times that of a simulation.
///
/// `observe` sees the steps done and may stop the measurement; what was measured so far is then returned.
///
/// # Errors
/// [`Error::OpenDomain`] unless the domain is periodic; [`Error::TimeStep`]; [`Error::StepTooLarge`]; [`Error::Tessellation`]; [`Error::NoFrames`]
/// if there is nothing to count.
///
/// ```
/// use std::ops::ControlFlow;
/// use voronudge_geometry::Domain;
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{honeycomb, measure::{LyapunovSchedule, largest_lyapunov_exponent}};
/// // A honeycomb at rest: perturbations decay at the rate of the slowest mode.
/// let (positions, cell_box) = honeycomb(16)?;
/// let model = Model::chiral_voronoi(&Parameters { preferred_perimeter: 3.0, ..Parameters::default() });
/// let schedule = LyapunovSchedule { time_step: 0.02, transient: 500, steps: 500, renormalisation: 10 };
/// let exponent = largest_lyapunov_exponent(
///     &positions, Domain::Periodic(cell_box), &model, &schedule, 1, |_| ControlFlow::Continue(()),
/// )?;
/// assert!(exponent.value < -0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn largest_lyapunov_exponent(
    positions: &[Vector<f64>],
    domain: Domain,
    model: &Model<f64>,
    schedule: &LyapunovSchedule,
    seed: u64,
    mut observe: impl FnMut(usize) -> ControlFlow<()>,
) -> Result<LyapunovExponent, Error> {
    Tangent::new(positions, domain, model, seed)?.exponent(schedule, &mut observe)
}

/// A trajectory and a tangent vector: a simulation of dual numbers.
struct Tangent {
    simulation: Simulation<Dual64>,
}

impl Tangent {
    fn new(positions: &[Vector<f64>], domain: Domain, model: &Model<f64>, seed: u64) -> Result<Self, Error> {
        let mut rng = generator(seed);
        let mut seeded = |x: f64| Dual64::new(x, rng.random_range(-1.0..1.0));
        let positions = positions.iter().map(|r| Vector::new(seeded(r.x), seeded(r.y))).collect();
        let mut tangent = Self { simulation: Simulation::new(positions, domain, model.lift())? };
        tangent.renormalise()?;
        Ok(tangent)
    }

    /// Follows both; `observe` is told of each step.
    fn exponent(
        mut self,
        schedule: &LyapunovSchedule,
        observe: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> Result<LyapunovExponent, Error> {
        let LyapunovSchedule { time_step, transient, steps, renormalisation } = *schedule;
        if !(time_step.is_finite() && time_step > 0.0) {
            return Err(Error::TimeStep { time_step });
        }
        let (mut rates, mut since) = (BlockAverage::default(), 0);
        for step in 1..=transient + steps {
            self.simulation.step(time_step)?;
            since += 1;
            if since >= renormalisation || step == transient {
                let rate = self.renormalise()?.ln() / (f64::from(since as u32) * time_step);
                if step > transient {
                    rates.add(rate);
                }
                since = 0;
            }
            if observe(step).is_break() {
                break;
            }
        }
        let value = rates.mean().ok_or(Error::NoFrames)?;
        Ok(LyapunovExponent { value, standard_error: rates.standard_error() })
    }

    /// Takes translations out of the tangent vector, makes its length one and returns the length it had.
    fn renormalise(&mut self) -> Result<f64, Error> {
        let mut length = 0.0;
        self.simulation.differentiate_by(|positions| {
            let cells = positions.len() as f64;
            let mean = positions.iter().map(tangent_of).sum::<Vector<f64>>() / cells;
            for r in positions.iter_mut() {
                r.x.eps -= mean.x;
                r.y.eps -= mean.y;
            }
            length = positions.iter().map(|r| tangent_of(r).norm_squared()).sum::<f64>().sqrt();
            for r in positions {
                r.x.eps /= length;
                r.y.eps /= length;
            }
        })?;
        Ok(length)
    }
}

fn tangent_of(r: &Vector<Dual64>) -> Vector<f64> {
    Vector::new(r.x.eps, r.y.eps)
}
