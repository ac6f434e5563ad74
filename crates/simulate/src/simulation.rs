//! The state of a simulation.

mod bonds;
mod derivatives;
mod replacement;
mod state;
mod step;

pub use bonds::Bond;
pub(crate) use derivatives::slopes;
pub use derivatives::{Direction, derivatives};
use state::Stage;
pub use state::State;

use crate::headings::Headings;
use crate::scaled::{real, without_derivatives, zero};
use crate::walls::{self, Mirrored};
use crate::{Driving, Error, Method, Shear, Walls};
use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Scalar, Tessellation, Vector};
use voronudge_model::{HalfEdgeForces, Model, VelocityAssembly};

/// Cells in a periodic box that move under a model: `dr_i/dt = v_i(r)`, and what [`Driving`] adds.
///
/// Positions are unwrapped: they run on across the boundary of the box, unless its shear goes beyond
/// [`PeriodicBox::runs_on`]. Velocities and tessellation always belong to the
/// current positions. All arrays are kept from step to step.
///
/// With dual numbers for `S` a whole run is differentiated, by whatever the model and the starting positions carry derivatives of: exactly the
/// derivatives of the numbers that the run computes, at the topology and the parts of steps that it went through. At a T1 they go over unchanged: where the force jumps there, what the
/// moment of the jump does is left out.
#[derive(Debug, Clone)]
pub struct Simulation<S: Scalar = f64> {
    model: Model<S>,
    method: Method,
    driving: Driving,
    tessellation: MovingTessellation,
    cell_box: PeriodicBox,
    mirrored: Option<Mirrored<S>>,
    spacing: f64,
    now: State<S>,
    velocities: Vec<Vector<S>>,
    assembly: VelocityAssembly<S>,
    /// Those at the current positions, where they are kept.
    forces: Option<HalfEdgeForces<S>>,
    /// What drives the polarities now.
    drive: Vec<Vector<S>>,
    stage: Stage<S>,
    /// Positions without derivatives.
    places: Vec<Vector<f64>>,
}

impl<S: Scalar> Simulation<S> {
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
    pub fn new(positions: Vec<Vector<S>>, domain: Domain, model: Model<S>) -> Result<Self, Error> {
        let Domain::Periodic(cell_box) = domain else {
            return Err(Error::OpenDomain);
        };
        let mut places = Vec::new();
        let tessellation = MovingTessellation::new(without_derivatives(&positions, &mut places), domain)
            .map_err(|source| Error::Tessellation { time: 0.0, source })?;
        let spacing = (cell_box.area() / positions.len() as f64).sqrt();
        let mut simulation = Self {
            model,
            method: Method::default(),
            driving: Driving::default(),
            tessellation,
            cell_box,
            mirrored: None,
            spacing,
            now: State { positions, ..State::default() },
            velocities: Vec::new(),
            assembly: VelocityAssembly::default(),
            forces: None,
            drive: Vec::new(),
            stage: Stage::default(),
            places,
        };
        simulation.settle()?;
        Ok(simulation)
    }

    /// The same with another method of integration.
    ///
    /// # Errors
    /// [`Error::Tolerance`] if a tolerance is not positive, or is more than the spacing of the cells.
    pub fn with_method(mut self, method: Method) -> Result<Self, Error> {
        if let Method::BogackiShampine { tolerance } = method
            && !(tolerance > 0.0 && tolerance <= 1.0)
        {
            return Err(Error::Tolerance { tolerance });
        }
        self.method = method;
        Ok(self)
    }

    /// The same with another model from now on.
    ///
    /// # Errors
    /// [`Error::Walls`] as in [`Simulation::with_walls`].
    pub fn with_model(mut self, model: Model<S>) -> Result<Self, Error> {
        if let Some(walls) = self.walls() {
            walls::check(walls, &model, &self.cell_box, &self.driving)?;
        }
        self.model = model;
        self.settle()?;
        Ok(self)
    }

    /// The same with shear, self-propulsion or noise from now on. A step strain shears the positions.
    ///
    /// # Errors
    /// [`Error::Driving`] if an amount is negative or not finite; [`Error::Tessellation`] if the sheared box is not usable.
    pub fn with_driving(mut self, driving: Driving) -> Result<Self, Error> {
        driving.check()?;
        if let Some(walls) = self.walls() {
            walls::check(walls, &self.model, &self.cell_box, &driving)?;
        }
        if let Some(Shear::Step { strain }) = driving.shear {
            for r in &mut self.now.positions {
                r.x = r.x + r.y * strain;
            }
        }
        self.now.set_polarities(&driving.first_headings(self.now.positions.len()));
        self.driving = driving;
        self.put_back()?;
        self.settle()?;
        Ok(self)
    }

    /// The same between torque-free walls from now on. Cells that are behind a wall are put where their mirror images are.
    ///
    /// # Errors
    /// [`Error::Walls`] if the box is sheared, or the model has effects that are not functions of areas and perimeters;
    /// [`Error::Tessellation`] if a cell lies on a wall.
    pub fn with_walls(mut self, walls: Walls) -> Result<Self, Error> {
        walls::check(walls, &self.model, &self.cell_box, &self.driving)?;
        let (mirrored, tessellation) = Mirrored::of(walls, &self.cell_box, &mut self.now.positions)
            .map_err(|source| Error::Tessellation { time: self.now.time, source })?;
        (self.mirrored, self.tessellation) = (Some(mirrored), tessellation);
        self.settle()?;
        Ok(self)
    }

    /// The same in a state that it, or another run of the same, was in. It goes on as that one, bit by bit.
    ///
    /// # Errors
    /// [`Error::State`] if the state is not one of these cells; [`Error::Tessellation`] as in [`Simulation::new`].
    pub fn in_state(mut self, state: State<S>) -> Result<Self, Error> {
        let cells = self.now.positions.len();
        let (positions, headings) = (state.positions.len(), state.headings.len());
        let speeds = state.speeds.len();
        if positions != cells || headings != self.now.headings.len() || speeds != self.now.speeds.len() {
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
        let many = self.now.positions.len() > step::CHUNK;
        let mut attempt = || match self.method {
            Method::RungeKutta4 => self.runge_kutta(&mut stage, time_step),
            Method::BogackiShampine { tolerance } => self.in_parts(&mut stage, time_step, tolerance),
        };
        // A parallel loop that starts outside the pool puts the caller to sleep, and the cells into another core's cache.
        let attempt = if many { rayon::scope(|_| attempt()) } else { attempt() };
        self.stage = stage;
        if attempt.is_err() {
            self.settle()?;
        }
        attempt
    }

    /// Cell centres (N), unwrapped.
    pub fn positions(&self) -> &[Vector<S>] {
        &self.now.positions
    }

    /// Velocities (N) at the current positions, with shear and self-propulsion, without noise.
    pub fn velocities(&self) -> &[Vector<S>] {
        &self.velocities
    }

    /// Positions of the cells of [`Simulation::tessellation`]: between walls the cells (N) and then their mirror images.
    pub fn positions_with_images(&self) -> &[Vector<S>] {
        self.mirrored.as_ref().map_or(self.positions(), |mirrored| &mirrored.positions)
    }

    /// The walls, if there are any.
    pub fn walls(&self) -> Option<Walls> {
        self.mirrored.as_ref().map(|mirrored| mirrored.walls)
    }

    /// Mean velocity along the wall of the cells that touch one, anticlockwise around the box; none without walls. A cell in a
    /// corner counts for both.
    pub fn edge_velocity(&self) -> Option<S> {
        self.mirrored.as_ref()?.edge_velocity(self.tessellation(), &self.velocities)
    }

    /// The tessellation of the current positions; between walls of [`Simulation::positions_with_images`].
    pub fn tessellation(&self) -> &Tessellation {
        self.tessellation.tessellation()
    }

    /// The model that moves the cells.
    pub fn model(&self) -> &Model<S> {
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
    pub fn state(&self) -> &State<S> {
        &self.now
    }

    /// The same with other scalars.
    fn carried_over<T: Scalar>(&self, model: Model<T>, now: State<T>) -> Result<Simulation<T>, Error> {
        let mut other = Simulation {
            model,
            method: self.method,
            driving: self.driving,
            tessellation: self.tessellation.clone(),
            cell_box: self.cell_box,
            mirrored: self.mirrored.as_ref().map(Mirrored::carried_over),
            spacing: self.spacing,
            now,
            velocities: Vec::new(),
            assembly: VelocityAssembly::default(),
            forces: self.forces.as_ref().map(|_| HalfEdgeForces::default()),
            drive: Vec::new(),
            stage: Stage::default(),
            places: Vec::new(),
        };
        other.settle()?;
        Ok(other)
    }

    /// Other derivatives of the positions, which stay where they are.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub(crate) fn differentiate_by(&mut self, change: impl FnOnce(&mut [Vector<S>])) -> Result<(), Error> {
        change(&mut self.now.positions);
        self.settle()
    }

    /// Velocities at positions of a time; the tessellation becomes theirs.
    fn evaluate(
        &mut self,
        positions: &Vec<Vector<S>>,
        headings: &Headings<S>,
        time: f64,
        velocities: &mut Vec<Vector<S>>,
    ) -> Result<(), Error> {
        if let Some(mirrored) = &mut self.mirrored {
            mirrored.place(positions);
            let places = without_derivatives(&mirrored.positions, &mut self.places);
            (self.tessellation.renew(places)).map_err(|source| Error::Tessellation { time, source })?;
            let tessellation = self.tessellation.tessellation();
            let (all, mirrors) = (&mirrored.positions, mirrored.walls.mirrors());
            velocities.resize(positions.len(), zero());
            let forces = self.forces.get_or_insert_default();
            forces.evaluate_with_images(tessellation, all, &self.model, mirrors, velocities);
            mirrored.unfold(velocities);
            self.driving.add_to(velocities, positions, headings, time);
            return Ok(());
        }
        let domain = self.domain_at(time);
        let places = without_derivatives(positions, &mut self.places);
        domain
            .and_then(|domain| self.tessellation.renew_in(places, domain))
            .map_err(|source| Error::Tessellation { time, source })?;
        let tessellation = self.tessellation.tessellation();
        match &mut self.forces {
            Some(forces) => forces.evaluate(tessellation, positions, &self.model, velocities),
            None => self.assembly.evaluate(tessellation, positions, &self.model, velocities),
        }
        self.driving.add_to(velocities, positions, headings, time);
        Ok(())
    }

    /// Tessellation and velocities become those of the current positions.
    fn settle(&mut self) -> Result<(), Error> {
        let (now, mut velocities) = (std::mem::take(&mut self.now), std::mem::take(&mut self.velocities));
        let outcome = self.evaluate(&now.positions, &now.polarities(), now.time, &mut velocities);
        (self.now, self.velocities) = (now, velocities);
        self.settle_drive();
        outcome
    }

    /// What drives the polarities becomes that of the current positions.
    fn settle_drive(&mut self) {
        if !self.driving.drives() || self.mirrored.is_some() {
            return;
        }
        let Self { now, tessellation, velocities, model, driving, .. } = self;
        let cells = (tessellation.tessellation(), now.positions.as_slice());
        let state = (&now.polarities(), now.time);
        self.drive = driving.drive(cells, velocities, state, &model.environment);
    }

    fn domain_at(&self, time: f64) -> Result<Domain, voronudge_geometry::Error> {
        Ok(Domain::Periodic(self.cell_box.after_shear(self.strain(time))?))
    }

    fn strain(&self, time: f64) -> f64 {
        self.driving.shear.map_or(0.0, |shear| shear.strain(time))
    }

    /// Puts cells back into a box that was sheared too far for them to run on, and says whether there were any outside.
    fn put_back(&mut self) -> Result<bool, Error> {
        let time = self.now.time;
        if self.cell_box.runs_on(self.strain(time)) {
            return Ok(false);
        }
        let domain = self.domain_at(time).map_err(|source| Error::Tessellation { time, source })?;
        let mut any = false;
        if let Domain::Periodic(cell_box) = domain {
            for r in &mut self.now.positions {
                let place = real(r);
                let back = cell_box.brought_back(place);
                any |= back != place;
                *r = Vector::new(r.x - place.x + back.x, r.y - place.y + back.y);
            }
        }
        Ok(any)
    }
}
