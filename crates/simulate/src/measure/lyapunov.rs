//! The largest Lyapunov exponent by tangent dynamics.

use crate::{Error, generator};
use num_dual::Dual64;
use rand::Rng;
use rayon::prelude::*;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, MovingTessellation, Scalar, Vector};
use voronudge_model::{HalfEdgeForces, Model};
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

/// Cells per task.
const CHUNK: usize = 1024;

/// The largest Lyapunov exponent of the trajectory from `positions` (N) in a periodic domain: the growth rate of a tangent
/// vector `δ̇ = J(r) δ` by exact Jacobian–vector products.
///
/// Positions and tangent vector go through the classical Runge–Kutta method together as dual numbers, so the tangent
/// map is the exact derivative of the numerical step at frozen topology. Uniform translations, whose exponent is zero, are
/// taken out. At a T1 the tangent vector goes over unchanged: where the force jumps there, the contribution of the jump
/// itself is not in λ. One step costs about four times that of a simulation.
///
/// `observe` sees the steps done and may stop the measurement; what was measured so far is then returned.
///
/// # Errors
/// [`Error::OpenDomain`] unless the domain is periodic; [`Error::TimeStep`]; [`Error::Tessellation`]; [`Error::NoFrames`]
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
    let LyapunovSchedule { time_step, transient, steps, renormalisation } = *schedule;
    if domain == Domain::Open {
        return Err(Error::OpenDomain);
    }
    if !(time_step.is_finite() && time_step > 0.0) {
        return Err(Error::TimeStep { time_step });
    }
    let mut tangent = Tangent::new(positions, domain, model, seed)?;
    let (mut rates, mut since) = (BlockAverage::default(), 0);
    for step in 1..=transient + steps {
        tangent.step(time_step)?;
        since += 1;
        if since >= renormalisation || step == transient {
            let rate = tangent.renormalise().ln() / (f64::from(since as u32) * time_step);
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

/// A trajectory and a tangent vector: dual numbers.
struct Tangent {
    model: Model<Dual64>,
    tessellation: MovingTessellation,
    forces: HalfEdgeForces<Dual64>,
    time: f64,
    positions: Vec<Vector<Dual64>>,
    stage: Vec<Vector<Dual64>>,
    slope: Vec<Vector<Dual64>>,
    sum: Vec<Vector<Dual64>>,
    real: Vec<Vector<f64>>,
}

impl Tangent {
    fn new(positions: &[Vector<f64>], domain: Domain, model: &Model<f64>, seed: u64) -> Result<Self, Error> {
        let tessellation = MovingTessellation::new(positions, domain)
            .map_err(|source| Error::Tessellation { time: 0.0, source })?;
        let mut rng = generator(seed);
        let mut seeded = |x: f64| Dual64::new(x, rng.random_range(-1.0..1.0));
        let positions = positions.iter().map(|r| Vector::new(seeded(r.x), seeded(r.y))).collect();
        let mut tangent = Self {
            model: model.lift(),
            tessellation,
            forces: HalfEdgeForces::default(),
            time: 0.0,
            positions,
            stage: Vec::new(),
            slope: Vec::new(),
            sum: Vec::new(),
            real: Vec::new(),
        };
        tangent.renormalise();
        Ok(tangent)
    }

    /// One step of the classical Runge–Kutta method.
    fn step(&mut self, time_step: f64) -> Result<(), Error> {
        self.sum.clear();
        self.sum.resize(self.positions.len(), zero());
        self.slope.clone_from(&self.sum);
        for (reach, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            self.stage.clone_from(&self.positions);
            add_scaled(&mut self.stage, &self.slope, reach * time_step);
            self.real.clear();
            self.real.extend(self.stage.iter().map(|r| Vector::new(r.x.real(), r.y.real())));
            let renewed = self.tessellation.renew(&self.real);
            renewed.map_err(|source| Error::Tessellation { time: self.time, source })?;
            self.forces.evaluate(self.tessellation.tessellation(), &self.stage, &self.model, &mut self.slope);
            add_scaled(&mut self.sum, &self.slope, weight);
        }
        add_scaled(&mut self.positions, &self.sum, time_step / 6.0);
        self.time += time_step;
        Ok(())
    }

    /// Takes translations out of the tangent vector, makes its length one and returns the length it had.
    fn renormalise(&mut self) -> f64 {
        let cells = self.positions.len() as f64;
        let mean = self.positions.iter().map(|r| Vector::new(r.x.eps, r.y.eps)).sum::<Vector<f64>>() / cells;
        for r in &mut self.positions {
            r.x.eps -= mean.x;
            r.y.eps -= mean.y;
        }
        let length = self.positions.iter().map(|r| r.x.eps * r.x.eps + r.y.eps * r.y.eps).sum::<f64>().sqrt();
        for r in &mut self.positions {
            r.x.eps /= length;
            r.y.eps /= length;
        }
        length
    }
}

fn zero() -> Vector<Dual64> {
    Vector::new(Dual64::from_re(0.0), Dual64::from_re(0.0))
}

/// `to += h v`
fn add_scaled(to: &mut [Vector<Dual64>], v: &[Vector<Dual64>], h: f64) {
    let rows = to.par_iter_mut().zip(v).with_min_len(CHUNK);
    rows.for_each(|(to, v)| {
        to.x += v.x * h;
        to.y += v.y * h;
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RandomPlacement, Simulation};
    use voronudge_geometry::PeriodicBox;
    use voronudge_model::Parameters;

    /// The tangent vector against the difference of two trajectories that begin close to each other, across no T1.
    #[test]
    fn the_tangent_vector_is_the_difference_of_neighbouring_trajectories() {
        let cell_box = PeriodicBox::new([6.0, 6.0]).unwrap();
        let domain = Domain::Periodic(cell_box);
        let start = RandomPlacement::new(36, cell_box).draw(&mut generator(3)).unwrap();
        let parameters = Parameters { preferred_perimeter: 3.6, chirality: 0.7, ..Parameters::default() };
        let model = Model::chiral_voronoi(&parameters);
        let mut tangent = Tangent::new(&start, domain, &model, 5).unwrap();
        let size = 1e-6;
        let beside = |sign: f64| {
            let at = |r: &Vector<Dual64>| {
                Vector::new(r.x.re + sign * size * r.x.eps, r.y.re + sign * size * r.y.eps)
            };
            Simulation::new(tangent.positions.iter().map(at).collect(), domain, model.clone()).unwrap()
        };
        let (mut plus, mut minus) = (beside(1.0), beside(-1.0));
        for _ in 0..20 {
            tangent.step(0.005).unwrap();
            plus.step(0.005).unwrap();
            minus.step(0.005).unwrap();
            assert_eq!(plus.tessellation().edges(), minus.tessellation().edges());
        }
        for ((plus, minus), exact) in plus.positions().iter().zip(minus.positions()).zip(&tangent.positions) {
            let difference = (plus - minus) / (2.0 * size);
            assert!((difference - Vector::new(exact.x.eps, exact.y.eps)).norm() < 1e-7, "{difference}");
        }
        assert!(tangent.renormalise() > 0.0);
    }
}
