//! One run at one point of the diagram.

use super::request::{Job, Quantity, Request};
use crate::failure::Failure;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_observables::{BlockAverage, hexatic, shape_indices};
use voronudge_simulate::measure::{LyapunovSchedule, largest_lyapunov_exponent};
use voronudge_simulate::moduli::{Elastic, Moduli, Settings, elastic_until};
use voronudge_simulate::{
    Completion, Event, RandomPlacement, Schedule, Simulation, generator, run, sort_in_space,
};
use voronudge_spectrum::{Character, LinearProblem, Selection, modes};

/// States looked at in a run; those in its second half are measured.
const FRAMES: usize = 100;
/// Of these, one in so many has its modes computed.
const FRAMES_PER_SPECTRUM: usize = 3;
/// What a step of tangent dynamics costs, in steps.
const TANGENT_COST: u64 = 4;

/// A number and its standard error within the run, where it is known.
pub(super) type Measured = [Option<f64>; 2];

/// What came of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    pub point: usize,
    pub replica: usize,
    pub seed: u64,
    pub values: BTreeMap<Quantity, Measured>,
    /// Why the run did not come to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// How far all runs are, and whether to stop.
#[derive(Debug, Default)]
pub(super) struct Watch {
    pub steps: AtomicU64,
    pub stop: AtomicBool,
}

impl Watch {
    fn after(&self, steps: u64) -> ControlFlow<()> {
        self.steps.fetch_add(steps, Ordering::Relaxed);
        if self.stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The schedule at a point: as many frames as there are steps for, up to a hundred.
fn schedule(request: &Request, point: usize) -> Schedule {
    let time_step = request.time_step(point);
    let frames = ((request.time / time_step) as usize).clamp(1, FRAMES);
    Schedule { time: request.time, time_step, frames }
}

/// About what a run costs, in steps.
pub(super) fn cost(request: &Request, point: usize) -> u64 {
    let steps = (request.time / request.time_step(point)).ceil() as u64;
    let tangent = request.quantities.contains(&Quantity::Lyapunov);
    steps * if tangent { 1 + TANGENT_COST } else { 1 }
}

/// Averages over the frames of the second half.
#[derive(Default)]
struct Averages {
    order: BlockAverage,
    modulus: BlockAverage,
    shape: BlockAverage,
    frequency: BlockAverage,
}

fn measured(average: &BlockAverage) -> Measured {
    [average.mean(), average.standard_error()]
}

/// Makes a run. `None` if it was stopped.
pub(super) fn measure(request: &Request, job: Job, watch: &Watch) -> Option<Record> {
    let record = |values, error| Record {
        point: job.point,
        replica: job.replica,
        seed: request.seed(job),
        values,
        error,
    };
    match values(request, job, watch) {
        Ok(values) => values.map(|values| record(values, None)),
        // A run that fails does so each time; the others can go on.
        Err(failure) => Some(record(BTreeMap::new(), Some(failure.message().to_owned()))),
    }
}

fn values(
    request: &Request,
    job: Job,
    watch: &Watch,
) -> Result<Option<BTreeMap<Quantity, Measured>>, Failure> {
    let asked = |quantity: Quantity| request.quantities.contains(&quantity);
    let cells = request.cells;
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
    let placement = RandomPlacement { cells, cell_box, least_distance: request.least_distance };
    let mut positions = placement.draw(&mut generator(request.seed(job)))?;
    sort_in_space(&mut positions, &cell_box);
    let domain = Domain::Periodic(cell_box);
    let mut simulation = Simulation::new(positions, domain, request.model(job)?)?;
    let schedule = schedule(request, job.point);
    let mut averages = Averages::default();
    let mut fault = None;
    let summary = run(&mut simulation, &schedule, |event| match event {
        Event::Frame(frame) if 2 * (frame.index + 1) > schedule.frames => {
            let (tessellation, positions) = (frame.simulation.tessellation(), frame.simulation.positions());
            if asked(Quantity::HexaticOrder) || asked(Quantity::HexaticModulus) {
                let hexatic = hexatic(tessellation, positions);
                averages.order.add(hexatic.order());
                averages.modulus.add(hexatic.mean_modulus);
            }
            if asked(Quantity::ShapeIndex) {
                averages.shape.add(shape_indices(tessellation, positions).iter().sum::<f64>() / cells as f64);
            }
            // Counted from the end, which is always looked at.
            let from_end = schedule.frames - 1 - frame.index;
            if asked(Quantity::MeanSquareFrequency) && from_end.is_multiple_of(FRAMES_PER_SPECTRUM) {
                match mean_square_frequency(frame.simulation) {
                    Ok(square) => averages.frequency.add(square),
                    Err(failure) => {
                        fault = Some(failure);
                        return ControlFlow::Break(());
                    }
                }
            }
            ControlFlow::Continue(())
        }
        Event::Frame(_) => ControlFlow::Continue(()),
        Event::Step { .. } => watch.after(1),
    })?;
    if let Some(failure) = fault {
        return Err(failure);
    }
    if summary.completion == Completion::Stopped {
        return Ok(None);
    }
    let mut values = BTreeMap::new();
    for &quantity in &request.quantities {
        let value = match quantity {
            Quantity::MeanSquareVelocity => {
                [summary.mean_square_velocity, summary.mean_square_velocity_error]
            }
            Quantity::HexaticOrder => measured(&averages.order),
            Quantity::HexaticModulus => measured(&averages.modulus),
            Quantity::T1Rate => [summary.transition_rate, None],
            Quantity::ShapeIndex => measured(&averages.shape),
            Quantity::MeanSquareFrequency => measured(&averages.frequency),
            Quantity::ShearModulus
            | Quantity::OddShearModulus
            | Quantity::BulkModulus
            | Quantity::OddBulkModulus => continue,
            Quantity::Lyapunov => match lyapunov(request, job, &simulation, watch)? {
                Some(value) => value,
                None => return Ok(None),
            },
        };
        values.insert(quantity, value);
    }
    if request.quantities.iter().any(|quantity| quantity.is_modulus()) {
        let Some(elastic) = elastic(&simulation, request.time_step(job.point), watch)? else {
            return Ok(None);
        };
        for &quantity in &request.quantities {
            let of: fn(&Moduli) -> f64 = match quantity {
                Quantity::ShearModulus => |moduli| moduli.shear,
                Quantity::OddShearModulus => |moduli| moduli.odd_shear,
                Quantity::BulkModulus => |moduli| moduli.bulk,
                Quantity::OddBulkModulus => |moduli| moduli.odd_bulk,
                _ => continue,
            };
            values.insert(quantity, [Some(of(&elastic.moduli)), Some(of(&elastic.errors))]);
        }
    }
    Ok(Some(values))
}

/// The moduli of the state at the end of a run.
fn elastic(simulation: &Simulation, time_step: f64, watch: &Watch) -> Result<Option<Elastic>, Failure> {
    let mut settings = Settings::default();
    settings.relaxation.time_step = time_step;
    match elastic_until(simulation, &settings, &|| watch.after(0)) {
        Ok(elastic) => Ok(Some(elastic)),
        Err(voronudge_simulate::Error::Interrupted) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// λ over a further run as long as the first.
fn lyapunov(
    request: &Request,
    job: Job,
    simulation: &Simulation,
    watch: &Watch,
) -> Result<Option<Measured>, Failure> {
    let schedule = LyapunovSchedule::over(request.time, request.time_step(job.point));
    let domain = simulation.tessellation().domain();
    let (positions, model) = (simulation.positions(), simulation.model());
    let exponent = largest_lyapunov_exponent(positions, domain, model, &schedule, request.seed(job), |_| {
        watch.after(TANGENT_COST)
    });
    if watch.stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let exponent = exponent?;
    Ok(Some([Some(exponent.value), exponent.standard_error]))
}

/// ⟨ω²⟩ over all modes of the Jacobian of a state.
fn mean_square_frequency(simulation: &Simulation) -> Result<f64, Failure> {
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions());
    let problem = LinearProblem::new(tessellation, positions, simulation.model(), |_| true)?;
    let request = voronudge_spectrum::Request {
        character: Character::None,
        ..voronudge_spectrum::Request::new(Selection::All)
    };
    let modes = modes(&problem, &request, &mut |_, _, _| {})?;
    modes.mean_square_frequency().ok_or_else(|| Failure::new("no modes were found"))
}
