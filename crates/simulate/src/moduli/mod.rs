//! Elastic moduli and viscosities of a periodic tissue, from its stress.
//!
//! [`elastic`] strains a prepared state by small amounts of both signs, lets it come to rest and takes the change of the
//! stress. [`viscous`] shears back and forth. Definitions and signs are those of the mean-field theory:
//!
//! ```text
//! (σ_xx + σ_yy)/2 = B ∇·u                  (σ_yx − σ_xy)/2 = A ∇·u
//! (σ_xx − σ_yy)/2 = μ e_1 + Kᵒ e_2         e_1 = ∂_x u_x − ∂_y u_y
//! (σ_xy + σ_yx)/2 = μ e_2 − Kᵒ e_1         e_2 = ∂_x u_y + ∂_y u_x
//! ```
//!
//! with the stress about the prestress, row = component of the force, per present area (Cauchy). Rates take the place of strains
//! and `η`, `ηᵒ` that of `μ`, `Kᵒ` in a liquid.
//!
//! ```
//! use voronudge_geometry::Domain;
//! use voronudge_model::{Model, Parameters};
//! use voronudge_simulate::{Simulation, honeycomb, moduli};
//! let (positions, cell_box) = honeycomb(16)?;
//! let parameters = Parameters { preferred_perimeter: 3.0, chirality: 0.3, ..Parameters::default() };
//! let model = Model::chiral_voronoi(&parameters);
//! let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
//! let elastic = moduli::elastic(&simulation, &moduli::Settings::default())?;
//! assert!((elastic.moduli.odd_shear + 3f64.sqrt() * 0.3).abs() < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod average;
mod deformation;
mod dynamic;
mod relaxation;
mod settled;
mod step;
mod uniform;
mod viscosity;

pub use deformation::{Deformation, Strain, parts, whole};
pub use dynamic::{Dynamic, DynamicModulus, DynamicProtocol, FEWEST_PERIODS, FEWEST_STEPS};
pub use relaxation::Relaxation;
pub use settled::Settled;
pub use step::after_a_step;
pub use uniform::{UniformState, UniformTissue};
pub use viscosity::{Viscosity, ViscosityProtocol, viscous};

use crate::{Error, Simulation};
use average::mean_stress;
use rayon::prelude::*;
use std::ops::ControlFlow;
use voronudge_geometry::Domain;
use voronudge_model::stress;

/// How moduli are measured. The defaults are for unit cells and `K_P = 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How a tissue is brought to rest, first unstrained and then strained.
    pub relaxation: Relaxation,
    /// The larger strain put on a tissue at rest; the smaller is half of it.
    pub strain: f64,
    /// What is done with a tissue that does not come to rest.
    pub flowing: Flowing,
}

impl Default for Settings {
    fn default() -> Self {
        Self { relaxation: Relaxation::default(), strain: 1e-5, flowing: Flowing::default() }
    }
}

/// How the stress of a tissue that does not come to rest is averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flowing {
    /// The larger strain; the smaller is half of it.
    pub strain: f64,
    /// Time after a strain that is not averaged over.
    pub transient: f64,
    /// Time that is averaged over.
    pub time: f64,
}

impl Default for Flowing {
    /// Longer averages than these make errors smaller than about 0.1 in 100 cells.
    fn default() -> Self {
        Self { strain: 0.1, transient: 20.0, time: 100.0 }
    }
}

/// Four numbers, one for each modulus of an isotropic plane medium (rate: friction is absorbed).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moduli {
    /// Bulk modulus `B`.
    pub bulk: f64,
    /// Odd bulk modulus `A`: torque of a dilation.
    pub odd_bulk: f64,
    /// Shear modulus `μ`.
    pub shear: f64,
    /// Odd shear modulus `Kᵒ`.
    pub odd_shear: f64,
}

/// Derivatives of stresses, row = `(σ_xx + σ_yy)/2`, `(σ_yx − σ_xy)/2`, `(σ_xx − σ_yy)/2`, `(σ_xy + σ_yx)/2`, by strains without
/// rotation, column = `∇·u`, `e_1`, `e_2` (rate: friction is absorbed).
pub type StressResponse = [[f64; 3]; 4];

impl Moduli {
    /// The isotropic part of a response: `μ` and `Kᵒ` are means of both shears.
    pub fn of(response: &StressResponse) -> Self {
        Self {
            bulk: response[0][0],
            odd_bulk: response[1][0],
            shear: 0.5 * (response[2][1] + response[3][2]),
            odd_shear: 0.5 * (response[2][2] - response[3][1]),
        }
    }

    /// `[B, A, μ, Kᵒ]`
    pub fn to_array(self) -> [f64; 4] {
        [self.bulk, self.odd_bulk, self.shear, self.odd_shear]
    }

    /// From `[B, A, μ, Kᵒ]`.
    pub fn from_array([bulk, odd_bulk, shear, odd_shear]: [f64; 4]) -> Self {
        Self { bulk, odd_bulk, shear, odd_shear }
    }

    /// A function of each modulus of several.
    pub(crate) fn each<const N: usize>(all: [Self; N], f: impl Fn([f64; N]) -> f64) -> Self {
        let arrays = all.map(Self::to_array);
        Self::from_array(std::array::from_fn(|k| f(arrays.map(|array| array[k]))))
    }
}

/// Whether a tissue came to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// It did, and moduli are differences between states at rest.
    AtRest,
    /// It did not, and moduli are differences between averages over time.
    Flowing,
}

/// The moduli of one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Elastic {
    /// Moduli after relaxation: means over both amplitudes.
    pub moduli: Moduli,
    /// Their standard errors: of four one-sided slopes (both signs and amplitudes) at rest, from averages over time otherwise. They
    /// do not know of the scatter from one disordered state to another.
    pub errors: Moduli,
    /// What the larger strain gives less what the smaller gives: zero for a linear response.
    pub nonlinearity: Moduli,
    /// Moduli for displacements that follow the strain, without relaxation, at the smaller strain.
    pub affine: Moduli,
    /// All responses after relaxation, which tell how far the state is from isotropic.
    pub response: StressResponse,
    /// The stress before, row = component of the force.
    pub prestress: [[f64; 2]; 2],
    /// Whether the tissue came to rest.
    pub motion: Motion,
    /// Largest speed at the end of the first relaxation.
    pub speed: f64,
    /// Strained states, of 12, that did not come to rest in time; zero in a flowing tissue.
    pub restless: usize,
}

/// Whoever may stop a measurement; asked from all threads.
pub type Stop<'a> = &'a (dyn Fn() -> ControlFlow<()> + Sync);

#[derive(Clone, Copy)]
struct Observer<'a>(Stop<'a>);

impl Observer<'_> {
    fn look(&self) -> Result<(), Error> {
        if self.0().is_break() { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// The moduli of the state that a simulation is in, after it has come to rest or while it flows.
///
/// The box and the cells are strained by `±h` and `±h/2`: bulk strain scales the box, the first shear stretches it by `exp(±h/2)`,
/// the second makes it oblique. The stretch is symmetric; where the frame of the box turns with it, the stress is turned
/// back, so the prestress contributes nothing. The model must know no direction and no place in the plane.
///
/// # Errors
/// [`Error::Strain`] for an amount that is not positive, finite and at most 0.5; the errors of [`Simulation::step`].
pub fn elastic(simulation: &Simulation, settings: &Settings) -> Result<Elastic, Error> {
    elastic_until(simulation, settings, &|| ControlFlow::Continue(()))
}

/// As [`elastic`], unless `stop` breaks it off; it is asked every 100 steps.
///
/// # Errors
/// [`Error::Interrupted`], and as [`elastic`].
pub fn elastic_until(simulation: &Simulation, settings: &Settings, stop: Stop<'_>) -> Result<Elastic, Error> {
    settings.check()?;
    Settled::new(simulation, &settings.relaxation, stop)?.elastic(settings, stop)
}

impl Settings {
    /// Refuses strains that are not small.
    ///
    /// # Errors
    /// [`Error::Strain`] for an amount that is not positive, finite and at most 0.5.
    pub fn check(&self) -> Result<(), Error> {
        for strain in [self.strain, self.flowing.strain] {
            if !(strain > 0.0 && strain <= LARGEST_STRAIN) {
                return Err(Error::Strain { strain, limit: LARGEST_STRAIN });
            }
        }
        Ok(())
    }
}

impl Settled {
    /// The moduli, as [`elastic_until`] measures them.
    ///
    /// # Errors
    /// As [`elastic_until`].
    pub fn elastic(&self, settings: &Settings, stop: Stop<'_>) -> Result<Elastic, Error> {
        settings.check()?;
        measured(self, settings, Observer(stop))
    }
}

fn measured(settled: &Settled, settings: &Settings, observer: Observer<'_>) -> Result<Elastic, Error> {
    let (base, motion) = (settled.simulation(), settled.motion());
    let largest = match motion {
        Motion::AtRest => settings.strain,
        Motion::Flowing => settings.flowing.strain,
    };
    let before = parts(stress_of(base));
    let jobs: Vec<_> = (Strain::ALL.into_iter())
        .flat_map(|strain| AMOUNTS.map(|share| Deformation::new(strain, share * largest)))
        .collect();
    let ends: Vec<StrainedState> = jobs
        .par_iter()
        .map(|deformation| strained(base, deformation, motion, settings, observer))
        .collect::<Result<_, Error>>()?;
    let prestress = match motion {
        Motion::AtRest => stress_of(base),
        Motion::Flowing => whole(std::array::from_fn(|k| {
            ends.iter().map(|end| end.after[k]).sum::<f64>() / ends.len() as f64
        })),
    };
    let slopes = |share: usize, of: fn(&StrainedState) -> [f64; 4]| -> StressResponse {
        std::array::from_fn(|part| {
            std::array::from_fn(|strain| {
                let (plus, minus) = (&ends[4 * strain + 2 * share], &ends[4 * strain + 2 * share + 1]);
                (of(plus)[part] - of(minus)[part]) / (2.0 * AMOUNTS[2 * share] * largest)
            })
        })
    };
    let (large, small) = (slopes(0, |end| end.after), slopes(1, |end| end.after));
    let response: StressResponse =
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (large[i][j] + small[i][j])));
    let moduli = Moduli::of(&response);
    let errors = match motion {
        Motion::AtRest => {
            let one_sided: [Moduli; 4] = std::array::from_fn(|k| {
                Moduli::of(&std::array::from_fn(|part| {
                    std::array::from_fn(|strain| {
                        (ends[4 * strain + k].after[part] - before[part]) / (AMOUNTS[k] * largest)
                    })
                }))
            });
            Moduli::each(one_sided, |slopes| standard_error(&slopes))
        }
        Motion::Flowing => propagated(&ends, largest),
    };
    Ok(Elastic {
        moduli,
        errors,
        nonlinearity: Moduli::each([Moduli::of(&large), Moduli::of(&small)], |[large, small]| large - small),
        affine: Moduli::of(&slopes(1, |end| end.affine)),
        response,
        prestress,
        motion,
        speed: settled.speed(),
        restless: ends.iter().filter(|end| !end.came_to_rest).count(),
    })
}

/// Strains of both signs, the larger first.
const AMOUNTS: [f64; 4] = [1.0, -1.0, 0.5, -0.5];

/// Beyond this no strain is small.
const LARGEST_STRAIN: f64 = 0.5;

/// The stress of a strained tissue, in parts.
struct StrainedState {
    affine: [f64; 4],
    after: [f64; 4],
    /// Standard errors of averages over time.
    errors: [f64; 4],
    came_to_rest: bool,
}

fn stress_of(simulation: &Simulation) -> [[f64; 2]; 2] {
    stress(simulation.tessellation(), simulation.positions(), simulation.model(), |_| true)
}

/// The same tissue in a strained box, with cells that follow the strain.
fn deformed(base: &Simulation, deformation: &Deformation) -> Result<Simulation, Error> {
    let Domain::Periodic(cell_box) = base.tessellation().domain() else {
        return Err(Error::OpenDomain);
    };
    let positions = base.positions().iter().map(|r| deformation.displaced(*r)).collect();
    let cell_box = deformation
        .cell_box(&cell_box)
        .map_err(|source| Error::Tessellation { time: base.time(), source })?;
    Simulation::new(positions, Domain::Periodic(cell_box), base.model().clone())
}

fn strained(
    base: &Simulation,
    deformation: &Deformation,
    motion: Motion,
    settings: &Settings,
    observer: Observer<'_>,
) -> Result<StrainedState, Error> {
    let mut simulation = deformed(base, deformation)?;
    let in_parts = |stress| parts(deformation.turn_back(stress));
    let affine = in_parts(stress_of(&simulation));
    match motion {
        Motion::AtRest => {
            let speed = settings.relaxation.relax(&mut simulation, observer)?;
            let after = in_parts(stress_of(&simulation));
            let came_to_rest = speed <= settings.relaxation.tolerance;
            Ok(StrainedState { affine, after, errors: [0.0; 4], came_to_rest })
        }
        Motion::Flowing => {
            let time_step = settings.relaxation.time_step;
            let mean = mean_stress(&mut simulation, &settings.flowing, time_step, &in_parts, observer)?;
            Ok(StrainedState { affine, after: mean.parts, errors: mean.errors, came_to_rest: true })
        }
    }
}

/// Errors of moduli from those of averages over time: the mean of two slopes, each of two states.
fn propagated(ends: &[StrainedState], largest: f64) -> Moduli {
    let variance = |part: usize, strain: usize| -> f64 {
        (0..4).map(|k| (0.25 * ends[4 * strain + k].errors[part] / (AMOUNTS[k] * largest)).powi(2)).sum()
    };
    Moduli {
        bulk: variance(0, 0).sqrt(),
        odd_bulk: variance(1, 0).sqrt(),
        shear: 0.5 * (variance(2, 1) + variance(3, 2)).sqrt(),
        odd_shear: 0.5 * (variance(2, 2) + variance(3, 1)).sqrt(),
    }
}

/// Standard error of the mean of independent values.
fn standard_error(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count * (count - 1.0))).sqrt()
}
