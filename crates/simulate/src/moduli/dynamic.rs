//! Storage and loss moduli: the stress under a strain that oscillates.

use super::deformation::{Deformation, Strain, parts};
use super::relaxation::SparseJacobian;
use super::settled::Settled;
use super::{Moduli, Motion, Observer, Stop, StressResponse, deformed, standard_error, stress_of};
use crate::simulation::derivatives;
use crate::{Direction, Driving, Error, Shear, Simulation};
use rayon::prelude::*;
use std::f64::consts::TAU;
use voronudge_geometry::Vector;
use voronudge_linalg::{Complex64, LinearSystem};
use voronudge_model::stress;

/// How storage and loss moduli are measured.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicProtocol {
    /// Angular frequencies ω (1/time).
    pub frequencies: Vec<f64>,
    /// The strain put on a tissue at rest, for derivatives by the strain.
    pub strain: f64,
    /// Amplitude of the shear of a tissue that flows.
    pub amplitude: f64,
    /// Time that a flowing tissue is sheared for, and that its stress is averaged over, at each frequency; a whole number of
    /// periods, at least [`FEWEST_PERIODS`], and one before these.
    pub time: f64,
    /// The time step of a flowing tissue; a period has at least [`FEWEST_STEPS`].
    pub time_step: f64,
}

/// Periods that are averaged over, at least.
pub const FEWEST_PERIODS: usize = 4;
/// Steps of a period, at least.
pub const FEWEST_STEPS: usize = 64;

/// A complex modulus `G* = G′ + i G″`: a strain `sin ωt` makes the stress `G′ sin ωt + G″ cos ωt` (rate).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicModulus {
    /// The storage modulus `G′`.
    pub storage: f64,
    /// The loss modulus `G″`.
    pub loss: f64,
    /// Standard error of the storage modulus, from one period to the next; zero in a tissue at rest, whose linear response is exact.
    pub storage_error: f64,
    /// The same of the loss modulus.
    pub loss_error: f64,
}

/// The response to one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamic {
    /// The angular frequency ω (1/time).
    pub frequency: f64,
    /// `B, A, μ, Kᵒ`; of a flowing tissue the shear moduli alone.
    pub moduli: [Option<DynamicModulus>; 4],
}

impl DynamicProtocol {
    /// Refuses amounts that are not positive and finite.
    ///
    /// # Errors
    /// [`Error::Rate`] for a frequency, strain, amplitude or time, [`Error::TimeStep`] for the step.
    pub fn check(&self) -> Result<(), Error> {
        let amounts = [("strain", self.strain), ("amplitude", self.amplitude), ("time", self.time)];
        let frequencies = self.frequencies.iter().map(|&own| ("angular frequency", own));
        for (name, value) in frequencies.chain(amounts) {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::Rate { name, value });
            }
        }
        if !(self.time_step.is_finite() && self.time_step > 0.0) {
            return Err(Error::TimeStep { time_step: self.time_step });
        }
        Ok(())
    }
}

impl Settled {
    /// Storage and loss moduli at each frequency, with cells rubbed by a medium that follows the strain, as in all other measurements of this
    /// module.
    ///
    /// A tissue at rest answers by its exact linear response. With displacements `u` from the affine ones, `u̇ = J u + f ε` and
    /// `σ = s ε + S u`,
    ///
    /// ```text
    /// G*(ω) = s + S (iω − J)⁻¹ f
    /// ```
    ///
    /// which is the modulus at rest for ω → 0 and that without relaxation for ω → ∞. A tissue that flows is sheared by `γ = amplitude sin ωt`,
    /// and the parts of its stress in phase and out of phase are averaged.
    ///
    /// # Errors
    /// Those of [`DynamicProtocol::check`]; [`Error::Interrupted`]; the errors of [`Simulation::step`].
    pub fn dynamic(&self, protocol: &DynamicProtocol, stop: Stop<'_>) -> Result<Vec<Dynamic>, Error> {
        protocol.check()?;
        let observer = Observer(stop);
        match self.motion() {
            Motion::AtRest => {
                let linear = Linear::new(self.simulation(), protocol.strain)?;
                let at = |&frequency: &f64| {
                    observer.look()?;
                    linear.at(frequency)
                };
                protocol.frequencies.par_iter().map(at).collect()
            }
            Motion::Flowing => {
                let at = |&frequency: &f64| oscillating(self.simulation(), frequency, protocol, observer);
                protocol.frequencies.par_iter().map(at).collect()
            }
        }
    }

    /// Derivatives of stresses by strains that oscillate with an angular frequency (1/time), in phase and out of phase, of a tissue at rest: all
    /// of what [`Settled::dynamic`] takes means of. `strain` is put on it for derivatives by the strain.
    ///
    /// # Errors
    /// [`Error::Response`]; the errors of [`Simulation::step`].
    pub fn linear_response(&self, frequency: f64, strain: f64) -> Result<[StressResponse; 2], Error> {
        Linear::new(self.simulation(), strain)?.response(frequency)
    }
}

/// The linear response of a tissue at rest.
struct Linear<'a> {
    base: &'a Simulation,
    jacobian: SparseJacobian,
    /// Derivatives of velocities by each strain, with cells that follow it.
    forces: [Vec<Vector<f64>>; 3],
    /// Derivatives of the stress by each strain, with cells that follow it.
    affine: StressResponse,
}

impl<'a> Linear<'a> {
    fn new(base: &'a Simulation, strain: f64) -> Result<Self, Error> {
        let mut affine = StressResponse::default();
        let mut forces = [const { Vec::new() }; 3];
        for (k, own) in Strain::ALL.into_iter().enumerate() {
            let side = |amount: f64| -> Result<_, Error> {
                let deformation = Deformation::new(own, amount);
                let tissue = deformed(base, &deformation)?;
                let stress = parts(deformation.turn_back(stress_of(&tissue)));
                Ok((tissue.velocities().to_vec(), stress))
            };
            let ((forward, above), (backward, below)) = (side(strain)?, side(-strain)?);
            let slope = |(a, b): (&Vector<f64>, &Vector<f64>)| (a - b) / (2.0 * strain);
            forces[k] = forward.iter().zip(&backward).map(slope).collect();
            (0..4).for_each(|part| affine[part][k] = (above[part] - below[part]) / (2.0 * strain));
        }
        Ok(Self { base, jacobian: SparseJacobian::of(base)?, forces, affine })
    }

    fn at(&self, frequency: f64) -> Result<Dynamic, Error> {
        let [storage, loss] = self.response(frequency)?.map(|own| Moduli::of(&own).to_array());
        let exact = |k: usize| {
            let (storage, loss) = (storage[k], loss[k]);
            Some(DynamicModulus { storage, loss, storage_error: 0.0, loss_error: 0.0 })
        };
        Ok(Dynamic { frequency, moduli: std::array::from_fn(exact) })
    }

    /// Derivatives of stresses by strains, in phase and out of phase.
    fn response(&self, frequency: f64) -> Result<[StressResponse; 2], Error> {
        // (J − iω) u = −f
        let system =
            LinearSystem::new(&self.jacobian.matrix, Complex64::new(0.0, frequency), &self.jacobian.places)
                .map_err(|source| Error::Response { frequency, source })?;
        let (mut storage, mut loss) = (self.affine, StressResponse::default());
        for (k, force) in self.forces.iter().enumerate() {
            let mut displacements: Vec<Complex64> =
                force.iter().flat_map(|f| [-f.x, -f.y]).map(Complex64::from).collect();
            system.solve(&mut displacements);
            let [real, imaginary] = self.stress_of_displacements(&displacements)?;
            for part in 0..4 {
                storage[part][k] += real[part];
                loss[part][k] += imaginary[part];
            }
        }
        Ok([storage, loss])
    }

    /// Derivatives of the parts of the stress along the real and the imaginary part of displacements of the cells.
    fn stress_of_displacements(&self, displacements: &[Complex64]) -> Result<[[f64; 4]; 2], Error> {
        let direction = |of: fn(&Complex64) -> f64| Direction {
            coefficients: Vec::new(),
            displacements: (displacements.chunks_exact(2))
                .map(|u| Vector::new(of(&u[0]), of(&u[1])))
                .enumerate()
                .collect(),
        };
        let run = self.base.along(&[direction(|u| u.re), direction(|u| u.im)])?;
        let stress = stress(run.tessellation(), run.positions_with_images(), run.model(), |_| true)
            .map(|row| row.map(|number| derivatives::<2>(&number)));
        Ok([0, 1].map(|k: usize| parts(stress.map(|row| row.map(|slopes| slopes[k])))))
    }
}

/// The shear moduli of a tissue that flows, sheared back and forth.
fn oscillating(
    from: &Simulation,
    frequency: f64,
    protocol: &DynamicProtocol,
    observer: Observer<'_>,
) -> Result<Dynamic, Error> {
    let amplitude = protocol.amplitude;
    let period = TAU / frequency;
    let steps = ((period / protocol.time_step).ceil() as usize).max(FEWEST_STEPS);
    let periods = ((protocol.time / period).ceil() as usize).max(FEWEST_PERIODS);
    // The clock begins with the shear.
    let (positions, domain) = (from.positions().to_vec(), from.tessellation().domain());
    let shear = Shear::Oscillatory { amplitude, angular_frequency: frequency };
    let mut tissue = Simulation::new(positions, domain, from.model().clone())?
        .with_driving(Driving { shear: Some(shear), ..Driving::default() })?;
    // Storage and loss of (σ_xy + σ_yx)/2, then of (σ_xx − σ_yy)/2, in each period.
    let mut found = [const { Vec::new() }; 4];
    for cycle in 0..=periods {
        let mut sums = [0.0; 4];
        for step in 1..=steps {
            tissue.step(period / steps as f64)?;
            if step.is_multiple_of(FEWEST_STEPS) {
                observer.look()?;
            }
            if cycle == 0 {
                continue;
            }
            let turn = Deformation::new(Strain::PureShear2, shear.strain(tissue.time()));
            let part = parts(turn.turn_back(stress_of(&tissue)));
            let (sine, cosine) = (TAU * step as f64 / steps as f64).sin_cos();
            let products = [part[3] * sine, part[3] * cosine, part[2] * sine, part[2] * cosine];
            sums.iter_mut().zip(products).for_each(|(sum, own)| *sum += own);
        }
        if cycle > 0 {
            let share = 2.0 / (amplitude * steps as f64);
            found.iter_mut().zip(sums).for_each(|(all, sum)| all.push(share * sum));
        }
    }
    let modulus = |[storage, loss]: [&Vec<f64>; 2]| {
        let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        Some(DynamicModulus {
            storage: mean(storage),
            loss: mean(loss),
            storage_error: standard_error(storage),
            loss_error: standard_error(loss),
        })
    };
    let [in_phase, out_of_phase, odd_in_phase, odd_out_of_phase] = &found;
    let moduli = [None, None, modulus([in_phase, out_of_phase]), modulus([odd_in_phase, odd_out_of_phase])];
    Ok(Dynamic { frequency, moduli })
}
