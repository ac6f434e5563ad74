//! The runs, and what they say together.

use crate::arguments::{Verbosity, named};
use crate::command::drawing::units_of_model;
use crate::command::moduli::replicas::over_replicas;
use crate::command::spectrum::mean_field;
use crate::failure::Failure;
use crate::progress::{Looks, Progress};
use crate::run::Run;
use rayon::prelude::*;
use std::sync::Mutex;
use voronudge_model::Parameters;
use voronudge_report::equation_of_state_report::{Honeycomb, Measured, UniformRecord};
use voronudge_report::{EquationOfStateReport, Units};
use voronudge_simulate::moduli::{UniformState, UniformTissue};
use voronudge_simulate::{recommended_time_step, seed_of_run};
use voronudge_theory::EquationOfState;

/// What is asked for, checked.
pub(super) struct Request {
    pub parameters: Parameters<f64>,
    pub cell_size: f64,
    /// In units of 1/ℓ₀².
    pub densities: Vec<f64>,
    pub cells: usize,
    pub replicas: usize,
    /// Before, and of, the averages.
    pub times: [f64; 2],
    pub time_step: Option<f64>,
    pub seed: u64,
}

/// The runs of a request.
pub(super) struct Work {
    tissues: Vec<UniformTissue>,
    replicas: usize,
    seed: u64,
    /// How often runs are looked at.
    looks: u64,
}

/// Root mean square velocity, in K_P ℓ₀, below which cells do not forget how they were put.
const SLOW: f64 = 0.01;
/// Steps between two looks.
const STEPS: u64 = 100;

impl Request {
    fn tissue(&self, density: f64) -> UniformTissue {
        UniformTissue {
            parameters: self.parameters,
            density: density / (self.cell_size * self.cell_size),
            cells: self.cells,
            times: self.times,
            time_step: self.time_step,
        }
    }

    /// The runs, if all of them can be made.
    pub fn work(&self) -> Result<Work, Failure> {
        let tissues: Vec<UniformTissue> = self.densities.iter().map(|own| self.tissue(*own)).collect();
        let steps = tissues.iter().map(UniformTissue::length).collect::<Result<Vec<_>, _>>()?;
        let looks = steps.iter().map(|steps| *steps as u64 / STEPS).sum::<u64>() * self.replicas as u64;
        Ok(Work { tissues, replicas: self.replicas, seed: self.seed, looks })
    }

    /// What should be known before.
    pub fn doubts(&self) -> Option<String> {
        let given = self.time_step?;
        let advised = |density: &f64| {
            recommended_time_step(&self.parameters, self.cell_size / density.sqrt()) * (1.0 + 1e-9)
        };
        let coarse = self.densities.iter().filter(|density| given > advised(density)).count();
        (coarse > 0).then(|| {
            format!(
                "the time step {given} is above the one advised at {coarse} of {} densities; flowing tissues can come out wrong by tens of per cent",
                self.densities.len()
            )
        })
    }

    /// Means over replicas, their slopes, and what to know of them; the states of each density one after another.
    pub fn points(&self, states: &[UniformState]) -> Result<(Vec<UniformRecord>, Vec<String>), Failure> {
        let at_density: Vec<&[UniformState]> = states.chunks(self.replicas).collect();
        let over = |values: Vec<f64>| {
            let (value, error) = over_replicas(&values, &[]);
            Measured { value, error }
        };
        let of = |get: fn(&UniformState) -> f64| -> Vec<Measured> {
            at_density.iter().map(|own| over(own.iter().map(get).collect())).collect()
        };
        let (pressure, torque) = (of(|own| own.pressure), of(|own| own.torque));
        let shape_index = of(|own| own.shape_index);
        let mean_square_velocity = of(|own| own.mean_square_velocity);
        let together: Vec<[f64; 3]> = (self.densities.iter().zip(&pressure).zip(&torque))
            .map(|((density, pressure), torque)| [*density, pressure.value, torque.value])
            .collect();
        let fault = |error: voronudge_theory::Error| {
            Failure::new(format!("the tissues have no equation of state: {error}"))
                .with_hint("did a run blow up? a smaller --dt may help")
        };
        let equation = EquationOfState::new(&together).map_err(fault)?;
        let slope_error = |point: usize, values: &[Measured]| {
            let shares = equation.slope_shares(point).map(|(k, share)| share * values[k].error);
            self.densities[point] * shares.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        let mut doubts = Vec::new();
        if equation.stiffness()[0] <= 0.0 {
            doubts.push(
                "the pressure does not rise with the density everywhere: there a uniform tissue is not stable, or the errors are too large for its slope"
                    .to_owned(),
            );
        }
        let slow = (SLOW * self.cell_size * self.parameters.perimeter_elasticity).powi(2);
        let solid = mean_square_velocity.iter().filter(|own| own.value <= slow).count();
        if solid > 0 {
            doubts.push(format!(
                "at {solid} of {} densities cells hardly move: a solid remembers how it was made, and its stress is not a function of the density alone",
                self.densities.len()
            ));
        }
        let points = (0..self.densities.len()).map(|k| {
            let [bulk, odd_bulk] = equation.moduli(k);
            UniformRecord {
                density: self.densities[k] / (self.cell_size * self.cell_size),
                relative_density: self.densities[k],
                pressure: pressure[k],
                torque: torque[k],
                shape_index: shape_index[k],
                mean_square_velocity: mean_square_velocity[k],
                bulk_modulus: Measured { value: bulk, error: slope_error(k, &pressure) },
                odd_bulk_modulus: Measured { value: odd_bulk, error: 0.5 * slope_error(k, &torque) },
                honeycomb: self.honeycomb(self.densities[k]),
            }
        });
        Ok((points.collect(), doubts))
    }

    /// The honeycomb of a density, in mean-field theory.
    pub fn honeycomb(&self, density: f64) -> Option<Honeycomb> {
        let spacing = self.cell_size / density.sqrt();
        let theory = mean_field(&self.parameters, spacing)?;
        let (sigma, moduli) = (theory.prestress(), theory.moduli());
        // The theory leaves out the pressure of the gauge A_0.
        let of_areas = self.parameters.area_elasticity * (self.parameters.preferred_area - spacing * spacing);
        Some(Honeycomb {
            pressure: of_areas - 0.5 * (sigma[0][0] + sigma[1][1]),
            torque: sigma[0][1] - sigma[1][0],
            bulk_modulus: moduli.bulk,
            odd_bulk_modulus: moduli.odd_bulk,
        })
    }

    pub fn report(&self, run: &Run, points: Vec<UniformRecord>) -> EquationOfStateReport {
        let named_units = Units { length: "length".into(), time: "time".into() };
        EquationOfStateReport {
            run: run.record(None),
            units: units_of_model(&named_units, self.cell_size, self.parameters.perimeter_elasticity),
            parameters: named(&self.parameters),
            cell_size: self.cell_size,
            cells: self.cells,
            replicas: self.replicas,
            relaxation: self.times[0],
            time: self.times[1],
            points,
        }
    }
}

impl Work {
    /// Makes all runs, several at a time.
    pub fn measure(&self, verbosity: Verbosity) -> Result<Vec<UniformState>, Failure> {
        let progress = Mutex::new(Progress::new(verbosity));
        let looks = Looks::new(&progress, "equation of state", self.looks);
        let stop = || looks.look();
        let states = (0..self.tissues.len() * self.replicas)
            .into_par_iter()
            .map(|task| {
                let (point, replica) = (task / self.replicas, task % self.replicas);
                let seed = seed_of_run(self.seed, point as u64, replica as u64);
                let place = || format!("{} cells per area", self.tissues[point].density);
                (self.tissues[point].measure(seed, &stop))
                    .map_err(|error| Failure::from(error).at_unless_interrupted(place()))
            })
            .collect::<Result<Vec<_>, Failure>>();
        if let Ok(shown) = progress.lock() {
            shown.finish();
        }
        states
    }
}
