//! What is measured: starts, settings, and the runs.

use super::Arguments;
use crate::arguments::Verbosity;
use crate::command::simulate::Start;
use crate::failure::Failure;
use crate::progress::Progress;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use voronudge_geometry::Domain;
use voronudge_model::{Model, Parameters};
use voronudge_simulate::moduli::{
    Elastic, Flowing, Relaxation, Settings, Viscosity, ViscosityProtocol, elastic_until, viscous,
};
use voronudge_simulate::{Error, Simulation, seed_of_replica};

/// Speeds in units of K_P ℓ₀ below which a tissue is at rest, and below which implicit steps are tried.
const AT_REST: f64 = 1e-10;
const SLOW: f64 = 1e-2;

pub(super) struct Protocol {
    pub settings: Settings,
    pub viscosity: Option<ViscosityProtocol>,
}

impl Protocol {
    pub fn new(arguments: &Arguments, parameters: &Parameters<f64>, time_step: f64, spacing: f64) -> Self {
        let speed = parameters.perimeter_elasticity.abs() * spacing;
        Self {
            settings: Settings {
                relaxation: Relaxation {
                    time_step,
                    longest: arguments.time,
                    tolerance: AT_REST * speed,
                    slow: SLOW * speed,
                },
                strain: arguments.strain,
                flowing: Flowing {
                    strain: arguments.flowing_strain,
                    transient: arguments.transient,
                    time: arguments.average,
                },
            },
            viscosity: arguments.viscosity.then_some(ViscosityProtocol {
                rate: arguments.rate,
                period: arguments.period,
                periods: arguments.periods,
                transient_periods: 1,
                time_step,
            }),
        }
    }

    /// About how often a replica is looked at, at most: every hundred steps.
    fn looks(&self) -> u64 {
        let Settings { relaxation, flowing, .. } = self.settings;
        let viscosity = self.viscosity.map_or(0.0, |v| v.period * (v.periods + v.transient_periods) as f64);
        let time = relaxation.longest + 12.0 * (flowing.transient + flowing.time) + viscosity;
        (time / relaxation.time_step / 100.0).min(1e15) as u64 + 1
    }
}

/// Replicas that nobody means.
const MOST_REPLICAS: u64 = 1000;

/// The starting positions of each replica, with their seed; at least one.
pub(super) fn starts(arguments: &Arguments) -> Result<Vec<(u64, Start)>, Failure> {
    if arguments.replicas == 0 {
        return Err(Failure::new("--replicas is 0, but at least one is needed")
            .with_hint("leave --replicas out for a single one"));
    }
    if arguments.replicas > MOST_REPLICAS {
        return Err(Failure::new(format!(
            "--replicas is {}, but {MOST_REPLICAS} are the most",
            arguments.replicas
        ))
        .with_hint("leave --replicas out for a single one"));
    }
    if arguments.replicas > 1 && !arguments.start.is_random() {
        return Err(Failure::new(format!("--replicas {} of one and the same start", arguments.replicas))
            .with_hint("replicas differ in random starting positions: leave --start out, or --replicas"));
    }
    let seeds = (0..arguments.replicas).map(|k| seed_of_replica(arguments.common.seed, k));
    seeds.map(|seed| Ok((seed, Start::of(&arguments.start, seed, 1)?))).collect()
}

pub(super) struct Measured {
    pub elastic: Elastic,
    pub viscosity: Option<Viscosity>,
}

/// Measures all replicas, one after another; the strained states of one run at the same time.
pub(super) fn replicas(
    starts: &[(u64, Start)],
    parameters: &Parameters<f64>,
    protocol: &Protocol,
    verbosity: Verbosity,
) -> Result<Vec<Measured>, Failure> {
    let progress = Mutex::new(Progress::new(verbosity));
    let mut measured = Vec::new();
    for (index, (_, start)) in starts.iter().enumerate() {
        let stage = format!("replica {} of {}", index + 1, starts.len());
        let (looks, most) = (AtomicU64::new(0), protocol.looks());
        let stop = || {
            let done = looks.fetch_add(1, Ordering::Relaxed).min(most);
            // A thread that cannot show progress goes on.
            progress.try_lock().map_or(ControlFlow::Continue(()), |mut shown| shown.step(&stage, done, most))
        };
        let model = Model::chiral_voronoi(parameters);
        let simulation = Simulation::new(start.positions.clone(), Domain::Periodic(start.cell_box), model)?;
        let interrupted = |error: Error| match error {
            Error::Interrupted => Failure::interrupted(),
            other => other.into(),
        };
        let elastic = elastic_until(&simulation, &protocol.settings, &stop).map_err(interrupted)?;
        let viscosity = (protocol.viscosity.as_ref())
            .map(|viscosity| viscous(&simulation, viscosity, &stop).map_err(interrupted))
            .transpose()?;
        measured.push(Measured { elastic, viscosity });
    }
    if let Ok(shown) = progress.lock() {
        shown.finish();
    }
    Ok(measured)
}
