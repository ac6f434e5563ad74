//! The state of a simulation and one step of it.

use crate::method::{THIRD_ORDER, change_of_step, largest_error};
use crate::{Driving, Error, Method, Shear};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Tessellation, Vector};
use voronudge_model::{HalfEdgeForces, Model};

/// Largest displacement in one step, in mean spacings.
const LIMIT: f64 = 1.0;

/// The part of a step below which the adaptive method goes on whatever the error: at a T1 the velocity may jump.
const LEAST_PART: f64 = 1e-6;

/// Cells per task in sums over fields.
const CHUNK: usize = 4096;

/// Cells in a periodic box that move under a model: `dr_i/dt = v_i(r)`, and what [`Driving`] adds.
///
/// Positions are unwrapped: they run on across the boundary of the box. Velocities and tessellation always belong to the
/// current positions. All arrays are kept from step to step.
#[derive(Debug, Clone)]
pub struct Simulation {
    model: Model<f64>,
    method: Method,
    driving: Driving,
    tessellation: MovingTessellation,
    cell_box: PeriodicBox,
    spacing: f64,
    now: State,
    velocities: Vec<Vector<f64>>,
    forces: HalfEdgeForces<f64>,
    stage: Stage,
}

/// All that a simulation needs to go on, besides what it was made of.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Time since the start.
    pub time: f64,
    /// Steps made, of the adaptive method parts of steps.
    pub steps: u64,
    /// The next part of a step of the adaptive method.
    pub part: Option<f64>,
    /// Cell centres (N), unwrapped, in the unit of the box.
    #[serde(skip)]
    pub positions: Vec<Vector<f64>>,
    /// Directions of self-propulsion (N, radians), or none.
    #[serde(skip)]
    pub headings: Vec<f64>,
}

/// Work space of one step.
#[derive(Debug, Clone, Default)]
struct Stage {
    positions: Vec<Vector<f64>>,
    headings: Vec<f64>,
    slopes: [Vec<Vector<f64>>; 3],
}

impl Simulation {
    /// Starts at time zero from `positions` (N, in the unit of the box).
    ///
    /// # Errors
    /// [`Error::OpenDomain`] unless the domain is periodic; [`Error::Tessellation`] if the positions cannot be
    /// tessellated (not finite, coincident, none).
    ///
    /// ```
    /// use voronudge_geometry::{Domain, PeriodicBox};
    /// use voronudge_model::{Model, Parameters};
    /// use voronudge_simulate::{RandomPlacement, Simulation, generator};
    /// let cell_box = PeriodicBox::new([6.0, 6.0])?;
    /// let positions = RandomPlacement::new(36, cell_box).draw(&mut generator(1))?;
    /// let model = Model::chiral_voronoi(&Parameters::default());
    /// let mut simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
    /// for _ in 0..5 {
    ///     simulation.step(0.02)?;
    /// }
    /// assert!((simulation.time() - 0.1).abs() < 1e-15);
    /// assert_eq!(simulation.velocities().len(), 36);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(positions: Vec<Vector<f64>>, domain: Domain, model: Model<f64>) -> Result<Self, Error> {
        let Domain::Periodic(cell_box) = domain else {
            return Err(Error::OpenDomain);
        };
        let tessellation = MovingTessellation::new(&positions, domain)
            .map_err(|source| Error::Tessellation { time: 0.0, source })?;
        let spacing = (cell_box.area() / positions.len() as f64).sqrt();
        let mut simulation = Self {
            model,
            method: Method::default(),
            driving: Driving::default(),
            tessellation,
            cell_box,
            spacing,
            now: State { positions, ..State::default() },
            velocities: Vec::new(),
            forces: HalfEdgeForces::default(),
            stage: Stage::default(),
        };
        simulation.settle()?;
        Ok(simulation)
    }

    /// The same with another method of integration.
    ///
    /// # Errors
    /// [`Error::Tolerance`] if a tolerance is not positive and finite.
    pub fn with_method(mut self, method: Method) -> Result<Self, Error> {
        if let Method::BogackiShampine { tolerance } = method
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(Error::Tolerance { tolerance });
        }
        self.method = method;
        Ok(self)
    }

    /// The same with shear, self-propulsion or noise from now on. A step strain shears the positions.
    ///
    /// # Errors
    /// [`Error::Driving`] if an amount is negative or not finite; [`Error::Tessellation`] if the sheared box is not usable.
    pub fn with_driving(mut self, driving: Driving) -> Result<Self, Error> {
        driving.check()?;
        if let Some(Shear::Step { strain }) = driving.shear {
            self.now.positions.iter_mut().for_each(|r| r.x += strain * r.y);
        }
        self.now.headings = driving.first_headings(self.now.positions.len());
        self.driving = driving;
        self.settle()?;
        Ok(self)
    }

    /// The same in a state that it, or another run of the same, was in. It goes on as that one, bit by bit.
    ///
    /// # Errors
    /// [`Error::State`] if the state is not one of these cells; [`Error::Tessellation`] as in [`Simulation::new`].
    pub fn in_state(mut self, state: State) -> Result<Self, Error> {
        let cells = self.now.positions.len();
        let (positions, headings) = (state.positions.len(), state.headings.len());
        if positions != cells || headings != self.now.headings.len() {
            return Err(Error::State { cells, positions, headings });
        }
        self.now = state;
        self.settle()?;
        Ok(self)
    }

    /// One step of the method, by default the classical Runge–Kutta method with four evaluations of the velocities:
    ///
    /// ```text
    /// k₁ = v(r)   k₂ = v(r + Δt k₁/2)   k₃ = v(r + Δt k₂/2)   k₄ = v(r + Δt k₃)
    /// r ← r + Δt (k₁ + 2k₂ + 2k₃ + k₄)/6
    /// ```
    ///
    /// The error of a trajectory without T1 transitions is of order `Δt⁴`; at a T1 the velocity has a kink or a jump, and
    /// the order is lost. [`recommended_time_step`](crate::recommended_time_step) has figures. The adaptive method cuts the
    /// step into as many parts as it needs.
    ///
    /// # Errors
    /// [`Error::TimeStep`] if `Δt` is not positive and finite; [`Error::StepTooLarge`] if a cell would move by more than
    /// the mean spacing or not to a finite place (a net for runs gone wrong, no promise of accuracy);
    /// [`Error::Tessellation`] if positions on the way cannot be tessellated. The simulation is then as it was before the
    /// step, with the adaptive method before the part that failed.
    pub fn step(&mut self, time_step: f64) -> Result<(), Error> {
        if !(time_step.is_finite() && time_step > 0.0) {
            return Err(Error::TimeStep { time_step });
        }
        let mut stage = std::mem::take(&mut self.stage);
        let attempt = match self.method {
            Method::RungeKutta4 => self.runge_kutta(&mut stage, time_step),
            Method::BogackiShampine { tolerance } => self.in_parts(&mut stage, time_step, tolerance),
        };
        self.stage = stage;
        if attempt.is_err() {
            self.settle()?;
        }
        attempt
    }

    /// Cell centres (N), unwrapped.
    pub fn positions(&self) -> &[Vector<f64>] {
        &self.now.positions
    }

    /// Velocities (N) at the current positions, with shear and self-propulsion, without noise.
    pub fn velocities(&self) -> &[Vector<f64>] {
        &self.velocities
    }

    /// The tessellation of the current positions.
    pub fn tessellation(&self) -> &Tessellation {
        self.tessellation.tessellation()
    }

    /// The model that moves the cells.
    pub fn model(&self) -> &Model<f64> {
        &self.model
    }

    /// Time since the start.
    pub fn time(&self) -> f64 {
        self.now.time
    }

    /// Mean spacing of the cells: the root of the mean area, in the unit of the box.
    pub(crate) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// What is needed to go on from here.
    pub fn state(&self) -> &State {
        &self.now
    }

    fn runge_kutta(&mut self, stage: &mut Stage, time_step: f64) -> Result<(), Error> {
        let Stage { positions, headings, slopes: [slope, sum, _] } = stage;
        sum.clone_from(&self.velocities);
        slope.clone_from(&self.velocities);
        headings.clone_from(&self.now.headings);
        for (reach, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            self.displace(positions, slope, reach * time_step, time_step)?;
            self.evaluate(positions, headings, self.now.time + reach * time_step, slope)?;
            add_scaled(sum, slope, weight);
        }
        self.displace(positions, sum, time_step / 6.0, time_step)?;
        self.arrive(positions, headings, slope, time_step)
    }

    /// Goes over to new positions after noise, and to their velocities.
    fn arrive(
        &mut self,
        positions: &mut Vec<Vector<f64>>,
        headings: &mut Vec<f64>,
        velocities: &mut Vec<Vector<f64>>,
        time_step: f64,
    ) -> Result<(), Error> {
        headings.clone_from(&self.now.headings);
        if self.driving.shakes() {
            self.driving.shake(positions, headings, self.now.steps, time_step);
            self.check_displacements(positions, time_step)?;
        }
        self.evaluate(positions, headings, self.now.time + time_step, velocities)?;
        std::mem::swap(&mut self.now.positions, positions);
        std::mem::swap(&mut self.now.headings, headings);
        std::mem::swap(&mut self.velocities, velocities);
        self.now.time += time_step;
        self.now.steps += 1;
        Ok(())
    }

    /// A step in parts of the embedded method of orders three and two.
    fn in_parts(&mut self, stage: &mut Stage, time_step: f64, tolerance: f64) -> Result<(), Error> {
        let end = self.now.time + time_step;
        let least = LEAST_PART * time_step;
        let allowed = tolerance * self.spacing;
        loop {
            let left = end - self.now.time;
            if left <= 1e-12 * time_step {
                self.now.time = end;
                return Ok(());
            }
            let wanted = self.now.part.unwrap_or(0.1 * time_step).max(least);
            let part = if wanted >= left { left } else { wanted };
            let share = match self.bogacki_shampine(stage, part) {
                Ok(error) => error / allowed,
                Err(Error::StepTooLarge { .. }) if part > least => f64::INFINITY,
                Err(error) => return Err(error),
            };
            if share > 1.0 && part > least {
                self.now.part = Some(part * change_of_step(share).min(0.9));
                continue;
            }
            let Stage { positions, headings, slopes: [_, _, last] } = &mut *stage;
            self.arrive(positions, headings, last, part)?;
            // The last part of a step is short for no reason of its own.
            self.now.part =
                Some((part * change_of_step(share)).max(if part < wanted { wanted } else { 0.0 }));
        }
    }

    /// Puts the result of third order into the stage and returns the largest estimated error of a displacement.
    fn bogacki_shampine(&mut self, stage: &mut Stage, time_step: f64) -> Result<f64, Error> {
        let Stage { positions, headings, slopes: [second, third, fourth] } = stage;
        let now = self.now.time;
        headings.clone_from(&self.now.headings);
        self.displace(positions, &self.velocities, 0.5 * time_step, time_step)?;
        self.evaluate(positions, headings, now + 0.5 * time_step, second)?;
        self.displace(positions, second, 0.75 * time_step, time_step)?;
        self.evaluate(positions, headings, now + 0.75 * time_step, third)?;
        positions.clone_from(&self.now.positions);
        for (slope, weight) in [&self.velocities, &*second, &*third].into_iter().zip(THIRD_ORDER) {
            add_scaled(positions, slope, weight * time_step);
        }
        self.check_displacements(positions, time_step)?;
        self.evaluate(positions, headings, now + time_step, fourth)?;
        Ok(largest_error([&self.velocities, second, third, fourth], time_step))
    }

    /// Velocities at positions of a time; the tessellation becomes theirs.
    fn evaluate(
        &mut self,
        positions: &[Vector<f64>],
        headings: &[f64],
        time: f64,
        velocities: &mut Vec<Vector<f64>>,
    ) -> Result<(), Error> {
        self.domain_at(time)
            .and_then(|domain| self.tessellation.renew_in(positions, domain))
            .map_err(|source| Error::Tessellation { time, source })?;
        self.forces.evaluate(self.tessellation.tessellation(), positions, &self.model, velocities);
        self.driving.add_to(velocities, positions, headings, time);
        Ok(())
    }

    /// Tessellation and velocities become those of the current positions.
    fn settle(&mut self) -> Result<(), Error> {
        let (now, mut velocities) = (std::mem::take(&mut self.now), std::mem::take(&mut self.velocities));
        let outcome = self.evaluate(&now.positions, &now.headings, now.time, &mut velocities);
        (self.now, self.velocities) = (now, velocities);
        outcome
    }

    fn domain_at(&self, time: f64) -> Result<Domain, voronudge_geometry::Error> {
        let lengths = self.cell_box.lengths();
        let strain = self.driving.shear.map_or(0.0, |shear| shear.strain(time));
        let offset = self.cell_box.offset() + strain * lengths[1];
        Ok(Domain::Periodic(PeriodicBox::sheared(lengths, offset)?))
    }

    /// `to = r + h v`, within the limit of displacements.
    fn displace(
        &self,
        to: &mut Vec<Vector<f64>>,
        v: &[Vector<f64>],
        h: f64,
        time_step: f64,
    ) -> Result<(), Error> {
        to.resize(v.len(), Vector::zeros());
        let from = self.now.positions.par_chunks(CHUNK);
        let limit = (LIMIT * self.spacing).powi(2);
        let near = to.par_chunks_mut(CHUNK).zip(from).zip(v.par_chunks(CHUNK)).map(|((to, from), v)| {
            let mut near = true;
            for ((to, from), v) in to.iter_mut().zip(from).zip(v) {
                let d = v * h;
                *to = from + d;
                near &= d.norm_squared() < limit;
            }
            near
        });
        // No short cut: every chunk has to be displaced.
        if near.reduce(|| true, |a, b| a & b) { Ok(()) } else { self.check_displacements(to, time_step) }
    }

    fn check_displacements(&self, positions: &[Vector<f64>], time_step: f64) -> Result<(), Error> {
        let streaming = self.driving.shear.map_or(0.0, |shear| shear.rate(self.now.time)) * time_step;
        let moved = |(to, from): (&Vector<f64>, &Vector<f64>)| {
            (to - from - Vector::new(streaming * from.y, 0.0)).norm()
        };
        let limit = LIMIT * self.spacing;
        let pairs = positions.par_iter().zip(&self.now.positions).with_min_len(CHUNK);
        match pairs.map(moved).position_first(|distance| distance.is_nan() || distance > limit) {
            None => Ok(()),
            Some(cell) => {
                let distance = moved((&positions[cell], &self.now.positions[cell]));
                Err(Error::StepTooLarge { time: self.now.time, cell, distance, limit, time_step })
            }
        }
    }
}

/// `sum += weight v`
fn add_scaled(sum: &mut [Vector<f64>], v: &[Vector<f64>], weight: f64) {
    let rows = sum.par_iter_mut().zip(v).with_min_len(CHUNK);
    rows.for_each(|(sum, v)| *sum += v * weight);
}
