//! Derivatives of a whole run, beside differences of runs.

use crate::simulation::{derivatives, slopes};
use crate::{Direction, Error, Schedule, Simulation};
use num_dual::DualSVec64;
use rayon::prelude::*;
use std::ops::ControlFlow;
use voronudge_geometry::{Arithmetic, Vector};
use voronudge_model::stress;

/// How far the runs to either side are, as what this alone would move cells by over the whole time, in mean spacings.
const ASIDE: f64 = 1e-3;

/// What a frame of a run changes by along a direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// Of the positions (N), unwrapped.
    pub positions: Vec<Vector<f64>>,
    /// Of ⟨v²⟩.
    pub mean_square_velocity: f64,
    /// Of the mean [`stress`], force index first.
    pub stress: [[f64; 2]; 2],
    /// By how much the derivatives of the positions miss the difference of two runs to either side: root mean square over the cells, over that of
    /// the derivatives; `None` where one of those runs could not go on.
    pub missed: Option<f64>,
}

impl Derivatives {
    /// Root mean square of the derivatives of the positions over the cells.
    pub fn root_mean_square(&self) -> f64 {
        root_mean_square(&self.positions)
    }
}

/// What a run changes by along a direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// How far along the direction the two other runs are, to either side.
    pub aside: f64,
    /// Frame by frame.
    pub frames: Vec<Derivatives>,
}

impl Sensitivity {
    /// How many frames there are before the first in which a derivative misses the difference of two runs by more than a share of its size.
    pub fn agreeing(&self, share: f64) -> usize {
        let agrees = |frame: &&Derivatives| frame.missed.is_some_and(|missed| missed <= share);
        self.frames.iter().take_while(agrees).count()
    }
}

fn root_mean_square(vectors: &[Vector<f64>]) -> f64 {
    let count = vectors.len().max(1) as f64;
    (vectors.iter().map(Vector::norm_squared).sum::<f64>() / count).sqrt()
}

/// A run that carries derivatives along some directions.
trait Differentiated: Send {
    fn step(&mut self, time_step: f64) -> Result<(), Error>;
    /// Of positions and of velocities along the direction of this number, root mean squares over the cells.
    fn sizes(&self, direction: usize) -> [f64; 2];
    fn frame(&self, direction: usize) -> Derivatives;
}

impl<const D: usize> Differentiated for Simulation<DualSVec64<D>> {
    fn step(&mut self, time_step: f64) -> Result<(), Error> {
        self.step(time_step)
    }

    fn sizes(&self, direction: usize) -> [f64; 2] {
        [self.positions(), self.velocities()].map(|all| root_mean_square(&slopes(all, direction)))
    }

    fn frame(&self, direction: usize) -> Derivatives {
        let positions = slopes(self.positions(), direction);
        let cells = positions.len();
        let squares: DualSVec64<D> =
            (self.velocities().iter()).fold(DualSVec64::constant(0.0), |sum, v| sum + v.x * v.x + v.y * v.y);
        let stress =
            stress(self.tessellation(), self.positions_with_images(), self.model(), |cell| cell < cells);
        let own = |number: DualSVec64<D>| derivatives(&number)[direction];
        Derivatives {
            positions,
            mean_square_velocity: own(squares) / cells as f64,
            stress: stress.map(|row| row.map(own)),
            missed: None,
        }
    }
}

/// Directions that one run carries at most: as many as the check of a run has.
const TOGETHER: usize = 5;

fn differentiated(
    simulation: &Simulation,
    directions: &[Direction],
) -> Result<Box<dyn Differentiated>, Error> {
    fn carried<const D: usize>(
        simulation: &Simulation,
        directions: &[Direction],
    ) -> Result<Box<dyn Differentiated>, Error> {
        let own: [Direction; D] = std::array::from_fn(|k| directions.get(k).cloned().unwrap_or_default());
        Ok(Box::new(simulation.along(&own)?))
    }
    // Each number of directions is an integrator to compile: some are carried for nothing.
    match directions.len() {
        1 => carried::<1>(simulation, directions),
        2 => carried::<2>(simulation, directions),
        _ => carried::<TOGETHER>(simulation, directions),
    }
}

/// Two runs to either side of one, as long as both can go on.
struct Beside {
    aside: f64,
    runs: Option<[Simulation; 2]>,
}

impl Beside {
    /// Of a run over some time, given the sizes of the derivatives at its start.
    fn new(
        simulation: &Simulation,
        direction: &Direction,
        [places, velocities]: [f64; 2],
        time: f64,
    ) -> Self {
        // A displaced cell is one of many.
        let places = places * (simulation.positions().len() as f64).sqrt();
        let aside = ASIDE * simulation.spacing() / (places + velocities * time).max(f64::MIN_POSITIVE);
        let runs = [aside, -aside].map(|way| simulation.beside(direction, way).ok());
        let [Some(plus), Some(minus)] = runs else { return Self { aside, runs: None } };
        Self { aside, runs: Some([plus, minus]) }
    }

    fn step(&mut self, time_step: f64) {
        let Some(runs) = &mut self.runs else { return };
        if runs.par_iter_mut().any(|run| run.step(time_step).is_err()) {
            self.runs = None;
        }
    }

    /// By how much derivatives of positions miss the difference.
    fn missed_by(&self, slopes: &[Vector<f64>]) -> Option<f64> {
        let [plus, minus] = self.runs.as_ref()?;
        let pairs = plus.positions().iter().zip(minus.positions());
        let differences = pairs.map(|(plus, minus)| (plus - minus) / (2.0 * self.aside));
        let missed: Vec<Vector<f64>> = differences.zip(slopes).map(|(seen, slope)| seen - slope).collect();
        let missed = root_mean_square(&missed) / root_mean_square(slopes);
        missed.is_finite().then_some(missed)
    }
}

/// Runs `simulation` from where it is by a schedule, with derivatives along some directions, and for each of these two runs to either side, for how long
/// derivatives say what a change does. `observe` is told after each step how many there are so far, and of how many; where it stops the run there is no
/// result.
///
/// # Errors
/// As [`run`](crate::run), and [`Error::NoSuchCell`].
///
/// ```
/// use std::ops::ControlFlow;
/// use voronudge_geometry::{Domain, PeriodicBox};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{Direction, RandomPlacement, Schedule, Simulation, generator, sensitivities};
/// let cell_box = PeriodicBox::new([5.0, 5.0])?;
/// let positions = RandomPlacement::new(25, cell_box).draw(&mut generator(1))?;
/// let parameters = Parameters { chirality: 0.5, ..Parameters::default() };
/// let tissue = Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(&parameters))?;
/// let by_alpha = Direction::parameter("alpha", &parameters).ok_or("no such parameter")?;
/// let schedule = Schedule { time: 0.1, time_step: 0.01, frames: 2 };
/// let found = sensitivities(&tissue, &schedule, &[by_alpha], |_, _| ControlFlow::Continue(()))?.ok_or("stopped")?;
/// assert_eq!(found[0].frames[1].positions.len(), 25);
/// assert!(found[0].agreeing(0.1) >= 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sensitivities(
    simulation: &Simulation,
    schedule: &Schedule,
    directions: &[Direction],
    mut observe: impl FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Option<Vec<Sensitivity>>, Error> {
    observed(simulation, schedule, directions, &mut observe)
}

/// The same, compiled here for all callers.
fn observed(
    simulation: &Simulation,
    schedule: &Schedule,
    directions: &[Direction],
    observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Option<Vec<Sensitivity>>, Error> {
    let steps_per_frame = schedule.steps_per_frame()?;
    let time_step = schedule.frame_interval() / steps_per_frame as f64;
    let total = steps_per_frame * schedule.frames;
    let mut runs: Vec<Box<dyn Differentiated>> =
        directions.chunks(TOGETHER).map(|some| differentiated(simulation, some)).collect::<Result<_, _>>()?;
    let mut beside: Vec<Beside> = directions
        .iter()
        .enumerate()
        .map(|(k, own)| Beside::new(simulation, own, runs[k / TOGETHER].sizes(k % TOGETHER), schedule.time))
        .collect();
    let mut found: Vec<Sensitivity> =
        beside.iter().map(|own| Sensitivity { aside: own.aside, frames: Vec::new() }).collect();
    for done in 1..=total {
        let (stepped, ()) = rayon::join(
            || runs.par_iter_mut().try_for_each(|run| run.step(time_step)),
            || beside.par_iter_mut().for_each(|own| own.step(time_step)),
        );
        stepped?;
        if done.is_multiple_of(steps_per_frame) {
            for (k, (own, beside)) in found.iter_mut().zip(&beside).enumerate() {
                let frame = runs[k / TOGETHER].frame(k % TOGETHER);
                let missed = beside.missed_by(&frame.positions);
                own.frames.push(Derivatives { missed, ..frame });
            }
        }
        if observe(done, total).is_break() {
            return Ok(None);
        }
    }
    Ok(Some(found))
}
