//! Extrusion and proliferation of cells between the steps of a simulation.

mod cycle;
mod disturbance;
mod lineage;
mod places;
mod rates;

pub use cycle::{CellCycle, DivisionAxis, Progress, distance_of_halves};
pub use lineage::{Life, Origin};
pub use rates::{EdgeRate, Injection, Proliferation, Turnover};

use crate::driving::stream;
use crate::{Bond, Channel, Error, Simulation};
use places::{Birth, Demand, Places};
use rand::Rng;
use voronudge_geometry::Vector;

/// A simulation whose cells are extruded and born, in a channel.
///
/// A step moves the cells and then draws the events of the step, each cell with the probability `1 − exp(−k Δt)`. The cells of the
/// tessellation keep their numbers 0 … N − 1; [`LivingTissue::identities`] tells which life each number stands for at the moment.
/// Random numbers come from the seed and the step.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{
///     EdgeRate, Injection, LivingTissue, Proliferation, RandomPlacement, Simulation, Turnover, generator,
/// };
/// let cell_box = PeriodicBox::new([8.0, 6.0])?;
/// let positions = RandomPlacement::new(48, cell_box).draw(&mut generator(1))?;
/// let model = Model::chiral_voronoi(&Parameters { chirality: 1.0, ..Parameters::default() });
/// let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
/// let turnover = Turnover {
///     extrusion: EdgeRate { rate: 1.0, decay_length: 1.4 },
///     proliferation: Proliferation::Replacing { decay_length: 0.25 },
///     injection: Injection::Vertex,
///     most_cells: 1000,
///     seed: 1,
/// };
/// let mut tissue = LivingTissue::new(simulation, turnover)?;
/// for _ in 0..200 {
///     tissue.step(0.01)?;
/// }
/// assert_eq!(tissue.simulation().positions().len(), 48); // one is born for each that is extruded
/// assert!(tissue.lives().len() > 48);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LivingTissue {
    simulation: Simulation,
    turnover: Turnover,
    channel: Channel,
    identities: Vec<usize>,
    lives: Vec<Life>,
    /// Where cells are in their cycles (N), if they have any.
    cycles: Vec<Progress>,
    last: LastStep,
}

/// What happened in a step: how each cell moved, and then which were extruded and born.
#[derive(Debug, Clone, Default)]
pub struct LastStep {
    /// The time step `Δt`.
    pub time_step: f64,
    /// Positions (N) before the step, unwrapped.
    pub from: Vec<Vector<f64>>,
    /// Positions of the same cells after they moved, before anything else; between walls in front of them.
    pub to: Vec<Vector<f64>>,
    /// Forces between the cells there ([`Simulation::bonds`]).
    pub bonds: Vec<Bond>,
    /// Where cells were extruded.
    pub extrusions: Vec<Vector<f64>>,
    /// Where cells were born.
    pub births: Vec<Vector<f64>>,
    /// Where cells divided, of which each has two of the births.
    pub divisions: Vec<Vector<f64>>,
}

impl LivingTissue {
    /// Turnover of the cells of a simulation from now on, in the channel of its box. Cells that have cycles are anywhere in them.
    ///
    /// # Errors
    /// [`Error::Turnover`] if a rate is negative or not finite, or a length not positive; [`Error::ShearedChannel`] for a
    /// sheared box, [`Error::ClosedChannel`] between four walls; [`Error::TooManyCells`] if there are too many already.
    pub fn new(mut simulation: Simulation, turnover: Turnover) -> Result<Self, Error> {
        turnover.check()?;
        let channel = Channel::of(&simulation)?;
        let (cells, time) = (simulation.positions().len(), simulation.time());
        if cells > turnover.most_cells {
            return Err(Error::TooManyCells { time, cells, limit: turnover.most_cells });
        }
        let lives = vec![Life::begun(Origin::Founder, time, None); cells];
        let identities = (0..cells).collect();
        let mut cycles = Vec::new();
        if let Injection::Cycle(cycle) = turnover.injection {
            let mut rng = stream(turnover.seed, simulation.state().steps, u64::MAX - 2);
            cycles.extend((0..cells).map(|_| cycle.anywhere(&mut rng)));
            simulation.give_factors(cycle.factors(&cycles))?;
        }
        let simulation = simulation.keeping_bonds()?;
        Ok(Self { simulation, turnover, channel, identities, lives, cycles, last: LastStep::default() })
    }

    /// The simulation: positions, velocities and tessellation of the cells alive.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The channel.
    pub fn channel(&self) -> Channel {
        self.channel
    }

    /// The life (index into [`LivingTissue::lives`]) of each cell of the simulation (N).
    pub fn identities(&self) -> &[usize] {
        &self.identities
    }

    /// All cells that ever lived, in the order of birth.
    pub fn lives(&self) -> &[Life] {
        &self.lives
    }

    /// Where each cell is in its cycle (N), if cells have cycles.
    pub fn cycles(&self) -> &[Progress] {
        &self.cycles
    }

    /// What happened in the last step.
    pub fn last_step(&self) -> &LastStep {
        &self.last
    }

    /// Moves the cells by a step `Δt` and then extrudes and adds cells.
    ///
    /// A step in which a cell would move too far, as may happen next to a new cell, is [cut into parts](Simulation::step_or_parts).
    ///
    /// # Errors
    /// Those of [`Simulation::step`]; [`Error::Extinct`], [`Error::TooManyCells`] and [`Error::NoPlace`] if the events of the
    /// step cannot be. The cells have moved then, and none is extruded or born.
    pub fn step(&mut self, time_step: f64) -> Result<(), Error> {
        self.last.time_step = time_step;
        self.last.from.clear();
        self.last.from.extend_from_slice(self.simulation.positions());
        self.last.extrusions.clear();
        self.last.births.clear();
        self.last.divisions.clear();
        let moved = self.simulation.step_or_parts(time_step);
        self.last.to.clear();
        self.last.to.extend_from_slice(self.simulation.positions());
        self.last.bonds.clear();
        moved?;
        self.simulation.put_bonds(&mut self.last.bonds);
        self.run_on(time_step);
        self.turn_over(time_step)
    }

    /// Phases of cells that divide at rates of their own.
    fn run_on(&mut self, time_step: f64) {
        if let Proliferation::Independent(rate) = self.turnover.proliferation {
            for (own, r) in self.cycles.iter_mut().zip(self.simulation.positions()) {
                own.phase += rate.at(self.channel.edge_distance(*r)) * time_step;
            }
        }
    }

    fn turn_over(&mut self, time_step: f64) -> Result<(), Error> {
        let mut rng = stream(self.turnover.seed, self.simulation.state().steps, u64::MAX);
        let extruded = self.drawn(self.turnover.extrusion, time_step, &mut rng);
        let demand = Demand::of(self, &extruded, time_step, &mut rng);
        let births = match &demand {
            Demand::Replacing { .. } => extruded.len(),
            Demand::Mothers(mothers) => mothers.len(),
        };
        if extruded.is_empty() && births == 0 {
            return self.grow();
        }
        let (time, limit) = (self.simulation.time(), self.turnover.most_cells);
        match self.identities.len() + births - extruded.len() {
            0 => return Err(Error::Extinct { time }),
            cells if cells > limit => return Err(Error::TooManyCells { time, cells, limit }),
            _ => {}
        }
        let mut places = Places::new(self, &extruded, births, time_step);
        let born = match demand {
            Demand::Replacing { decay_length } => places.weighted(decay_length, &mut rng)?,
            Demand::Mothers(mothers) => mothers
                .into_iter()
                .map(|mother| places.of_mother(mother, &mut rng))
                .collect::<Result<_, _>>()?,
        };
        let cycles = places.into_cycles();
        self.exchange(&extruded, &born, cycles, &mut rng)
    }

    /// Cells become as large as they are to be at their phases.
    fn grow(&mut self) -> Result<(), Error> {
        match self.turnover.injection {
            Injection::Cycle(cycle) => self.simulation.give_factors(cycle.factors(&self.cycles)),
            _ => Ok(()),
        }
    }

    /// The cells for which an event of a rate happens in a step, ascending.
    fn drawn(&self, rate: EdgeRate, time_step: f64, rng: &mut impl Rng) -> Vec<usize> {
        if rate.rate == 0.0 {
            return Vec::new();
        }
        let positions = self.simulation.positions().iter().enumerate();
        let happens = |&(_, r): &(usize, &Vector<f64>)| {
            rng.random::<f64>() < rate.probability(self.channel.edge_distance(*r), time_step)
        };
        positions.filter(happens).map(|(cell, _)| cell).collect()
    }

    /// New cells take the numbers of extruded ones, and one of two daughters that of her mother; the rest is appended or closed up.
    fn exchange(
        &mut self,
        extruded: &[usize],
        born: &[Birth],
        cycles: Vec<Progress>,
        rng: &mut impl Rng,
    ) -> Result<(), Error> {
        let time = self.simulation.time();
        let state = self.simulation.state();
        let (mut positions, mut headings) = (state.positions.clone(), state.headings.clone());
        let (mut identities, mut cycles) = (self.identities.clone(), cycles);
        let cycle = match self.turnover.injection {
            Injection::Cycle(cycle) => Some(cycle),
            _ => None,
        };
        let origin = match self.turnover.injection {
            Injection::Vertex => Origin::Vertex,
            Injection::Division { .. } | Injection::Cycle(_) => Origin::Division,
        };
        let mut lives = Vec::new();
        for (order, birth) in born.iter().enumerate() {
            let mother = birth.mother.map(|cell| self.identities[cell]);
            let own = [(Some(birth.place), extruded.get(order)), (birth.sister, birth.mother.as_ref())];
            for (place, cell) in own.into_iter().filter_map(|(place, cell)| Some((place?, cell))) {
                let life = self.lives.len() + lives.len();
                lives.push(Life::begun(origin, time, mother));
                let heading =
                    (!state.headings.is_empty()).then(|| rng.random_range(0.0..std::f64::consts::TAU));
                let progress = cycle.map(|cycle| cycle.newborn(rng));
                if let Some(&cell) = cell {
                    (positions[cell], identities[cell]) = (place, life);
                    headings.iter_mut().skip(cell).take(1).zip(heading).for_each(|(old, new)| *old = new);
                    cycles.iter_mut().skip(cell).take(1).zip(progress).for_each(|(old, new)| *old = new);
                } else {
                    positions.push(place);
                    identities.push(life);
                    headings.extend(heading);
                    cycles.extend(progress);
                }
            }
        }
        for &cell in extruded.iter().skip(born.len()).rev() {
            positions.remove(cell);
            identities.remove(cell);
            if !headings.is_empty() {
                headings.remove(cell);
            }
            if !cycles.is_empty() {
                cycles.remove(cell);
            }
        }
        match cycle {
            Some(cycle) => {
                self.simulation.replace_cells_with(positions, headings, cycle.factors(&cycles))?;
            }
            None => self.simulation.replace_cells(positions, headings)?,
        }
        for &cell in extruded {
            self.lives[self.identities[cell]].extruded = Some(time);
            self.last.extrusions.push(self.last.to[cell]);
        }
        self.lives.extend(lives);
        for birth in born {
            self.last.births.push(birth.place);
            if let (Some(place), Some(mother)) = (birth.sister, birth.mother) {
                self.lives[self.identities[mother]].divided = Some(time);
                self.last.births.push(place);
                self.last.divisions.push(self.last.to[mother]);
            }
        }
        (self.identities, self.cycles) = (identities, cycles);
        Ok(())
    }
}
