//! The state of a simulation and one step of it.

use crate::Error;
use rayon::prelude::*;
use voronudge_geometry::{Domain, MovingTessellation, Tessellation, Vector};
use voronudge_model::{HalfEdgeForces, Model};

/// Largest displacement in one step, in mean spacings.
const LIMIT: f64 = 1.0;

/// Cells per task in sums over fields.
const CHUNK: usize = 4096;

/// Cells in a periodic box that move under a model: `dr_i/dt = v_i(r)`.
///
/// Positions are unwrapped: they run on across the boundary of the box. Velocities and tessellation always belong to the
/// current positions. All arrays are kept from step to step.
#[derive(Debug, Clone)]
pub struct Simulation {
    model: Model<f64>,
    tessellation: MovingTessellation,
    time: f64,
    positions: Vec<Vector<f64>>,
    velocities: Vec<Vector<f64>>,
    /// Largest displacement in one step.
    limit: f64,
    forces: HalfEdgeForces<f64>,
    stage: Stage,
}

/// Work space of one step.
#[derive(Debug, Clone, Default)]
struct Stage {
    positions: Vec<Vector<f64>>,
    velocities: Vec<Vector<f64>>,
    /// Weighted sum of the velocities of the stages so far.
    sum: Vec<Vector<f64>>,
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
        let limit = LIMIT * (cell_box.area() / positions.len() as f64).sqrt();
        let mut forces = HalfEdgeForces::default();
        let mut velocities = Vec::new();
        forces.evaluate(tessellation.tessellation(), &positions, &model, &mut velocities);
        Ok(Self {
            model,
            tessellation,
            time: 0.0,
            positions,
            velocities,
            limit,
            forces,
            stage: Stage::default(),
        })
    }

    /// One step of the classical Runge–Kutta method, four evaluations of the velocities:
    ///
    /// ```text
    /// k₁ = v(r)   k₂ = v(r + Δt k₁/2)   k₃ = v(r + Δt k₂/2)   k₄ = v(r + Δt k₃)
    /// r ← r + Δt (k₁ + 2k₂ + 2k₃ + k₄)/6
    /// ```
    ///
    /// The error of a trajectory without T1 transitions is of order `Δt⁴`; at a T1 the velocity has a kink or a jump, and
    /// the order is lost. [`recommended_time_step`](crate::recommended_time_step) has figures.
    ///
    /// # Errors
    /// [`Error::TimeStep`] if `Δt` is not positive and finite; [`Error::StepTooLarge`] if a cell would move by more than
    /// the mean spacing or not to a finite place (a net for runs gone wrong, no promise of accuracy);
    /// [`Error::Tessellation`] if positions on the way cannot be tessellated. The simulation is then as it was before the
    /// step.
    pub fn step(&mut self, time_step: f64) -> Result<(), Error> {
        if !(time_step.is_finite() && time_step > 0.0) {
            return Err(Error::TimeStep { time_step });
        }
        let attempt = self.attempt(time_step);
        if attempt.is_err() {
            // The stages have replaced the topology; that of the positions was found before.
            self.renew_tessellation_of_positions()?;
        }
        attempt
    }

    /// Cell centres (N), unwrapped.
    pub fn positions(&self) -> &[Vector<f64>] {
        &self.positions
    }

    /// Velocities (N) at the current positions.
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
        self.time
    }

    fn attempt(&mut self, time_step: f64) -> Result<(), Error> {
        self.stage.sum.clone_from(&self.velocities);
        self.stage.velocities.clone_from(&self.velocities);
        for (reach, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let Stage { positions, velocities, .. } = &mut self.stage;
            displace(positions, &self.positions, velocities, reach * time_step);
            self.check_displacements(time_step)?;
            self.evaluate_stage(reach * time_step)?;
            let Stage { velocities, sum, .. } = &mut self.stage;
            add_scaled(sum, velocities, weight);
        }
        let Stage { positions, sum, .. } = &mut self.stage;
        displace(positions, &self.positions, sum, time_step / 6.0);
        self.check_displacements(time_step)?;
        self.evaluate_stage(time_step)?;
        std::mem::swap(&mut self.positions, &mut self.stage.positions);
        std::mem::swap(&mut self.velocities, &mut self.stage.velocities);
        self.time += time_step;
        Ok(())
    }

    /// Velocities at the positions of the stage, `after` the current time.
    fn evaluate_stage(&mut self, after: f64) -> Result<(), Error> {
        let Stage { positions, velocities, .. } = &mut self.stage;
        self.tessellation
            .renew(positions)
            .map_err(|source| Error::Tessellation { time: self.time + after, source })?;
        self.forces.evaluate(self.tessellation.tessellation(), positions, &self.model, velocities);
        Ok(())
    }

    fn renew_tessellation_of_positions(&mut self) -> Result<(), Error> {
        let time = self.time;
        match self.tessellation.renew(&self.positions) {
            Ok(_) => Ok(()),
            Err(source) => Err(Error::Tessellation { time, source }),
        }
    }

    fn check_displacements(&self, time_step: f64) -> Result<(), Error> {
        let limit = self.limit;
        let moved = |(to, from): (&Vector<f64>, &Vector<f64>)| (to - from).norm();
        let pairs = self.stage.positions.par_iter().zip(&self.positions).with_min_len(CHUNK);
        match pairs.map(moved).position_first(|distance| distance.is_nan() || distance > limit) {
            None => Ok(()),
            Some(cell) => {
                let distance = (self.stage.positions[cell] - self.positions[cell]).norm();
                Err(Error::StepTooLarge { time: self.time, cell, distance, limit, time_step })
            }
        }
    }
}

/// `to = from + h v`
fn displace(to: &mut Vec<Vector<f64>>, from: &[Vector<f64>], v: &[Vector<f64>], h: f64) {
    to.resize(from.len(), Vector::zeros());
    let rows = to.par_iter_mut().zip(from).zip(v).with_min_len(CHUNK);
    rows.for_each(|((to, from), v)| *to = from + v * h);
}

/// `sum += weight v`
fn add_scaled(sum: &mut [Vector<f64>], v: &[Vector<f64>], weight: f64) {
    let rows = sum.par_iter_mut().zip(v).with_min_len(CHUNK);
    rows.for_each(|(sum, v)| *sum += v * weight);
}
