//! What is measured: starts, settings, and the runs.

use super::Arguments;
use super::protocol::Protocol;
use crate::arguments::{CellArguments, Spreads, Verbosity};
use crate::command::simulate::Start;
use crate::failure::Failure;
use crate::progress::{Looks, Progress};
use std::sync::Mutex;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::moduli::{Dynamic, Elastic, Settled, Viscosity, viscous};
use voronudge_simulate::{Simulation, seed_of_replica};

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

/// The model of each replica; the parameters become the means over cells.
pub(super) fn models(
    cells: &CellArguments,
    spreads: &Spreads,
    starts: &[(u64, Start)],
    parameters: &mut Parameters<f64>,
) -> Result<Vec<Model<f64>>, Failure> {
    let given = *parameters;
    let model = |(seed, start): &(u64, Start)| {
        let (count, labels) = (start.positions.len(), start.labels.as_deref());
        *parameters = given;
        let own = cells.read(count, labels, parameters)?.and(spreads.draw(count, *seed, parameters)?)?;
        own.model(parameters, count, start.labels.clone())
    };
    starts.iter().map(model).collect()
}

pub(crate) struct Measured {
    pub elastic: Elastic,
    pub viscosity: Option<Viscosity>,
    pub dynamic: Vec<Dynamic>,
    /// Where the tissue came to rest, or was when it was given up.
    pub positions: Vec<Vector<f64>>,
}

/// Measures all replicas, one after another; the strained states of one run at the same time.
pub(super) fn replicas(
    starts: &[(u64, Start)],
    models: &[Model<f64>],
    protocol: &Protocol,
    verbosity: Verbosity,
) -> Result<Vec<Measured>, Failure> {
    let progress = Mutex::new(Progress::new(verbosity));
    let mut measured = Vec::new();
    for (index, ((_, start), model)) in starts.iter().zip(models).enumerate() {
        let stage = format!("replica {} of {}", index + 1, starts.len());
        let tissue = (start.positions.as_slice(), start.cell_box);
        measured.push(one(tissue, model, protocol, &stage, &progress)?);
    }
    if let Ok(shown) = progress.lock() {
        shown.finish();
    }
    Ok(measured)
}

/// Measures one tissue.
pub(crate) fn one(
    (positions, cell_box): (&[Vector<f64>], PeriodicBox),
    model: &Model<f64>,
    protocol: &Protocol,
    stage: &str,
    progress: &Mutex<Progress>,
) -> Result<Measured, Failure> {
    let looks = Looks::new(progress, stage, protocol.looks());
    let stop = || looks.look();
    let simulation = Simulation::new(positions.to_vec(), Domain::Periodic(cell_box), model.clone())?;
    let settled = Settled::new(&simulation, &protocol.settings.relaxation, &stop)?;
    let elastic = settled.elastic(&protocol.settings, &stop)?;
    let dynamic =
        (protocol.dynamic.as_ref()).map_or(Ok(Vec::new()), |dynamic| settled.dynamic(dynamic, &stop))?;
    let viscosity =
        (protocol.viscosity.as_ref()).map(|viscosity| viscous(&simulation, viscosity, &stop)).transpose()?;
    let positions = settled.simulation().positions().to_vec();
    Ok(Measured { elastic, viscosity, dynamic, positions })
}
