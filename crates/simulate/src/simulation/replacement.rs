//! Other cells in place of those of a simulation.

use super::Simulation;
use crate::Error;
use crate::scaled::without_derivatives;
use crate::walls::Mirrored;
use std::sync::Arc;
use voronudge_geometry::{PeriodicBox, Scalar, Vector};
use voronudge_model::{CellFactors, Environment, EnvironmentError};

impl<S: Scalar> Simulation<S> {
    /// The periodic box, as it was before any shear.
    pub fn cell_box(&self) -> PeriodicBox {
        self.cell_box
    }

    /// Goes on from now with other cells: `positions` (N, in the unit of the box) in place of those that are there, and
    /// `headings` (N, radians) if cells propel themselves, otherwise none. The number of cells may change; time and steps
    /// go on. Cells behind a wall are put where their mirror images are.
    ///
    /// # Errors
    /// [`Error::FreeSpeed`] if speeds of self-propulsion vary; [`Error::State`] if the directions are not those of as many cells; [`Error::Tessellation`] if the positions cannot be
    /// tessellated (not finite, coincident with another or, on a wall, with its own image, none). The simulation is then as it was.
    ///
    /// ```
    /// use voronudge_geometry::{Domain, PeriodicBox, Vector};
    /// use voronudge_model::{Model, Parameters};
    /// use voronudge_simulate::{RandomPlacement, Simulation, generator};
    /// let cell_box = PeriodicBox::new([6.0, 6.0])?;
    /// let positions = RandomPlacement::new(36, cell_box).draw(&mut generator(1))?;
    /// let model = Model::chiral_voronoi(&Parameters::default());
    /// let mut simulation = Simulation::new(positions.clone(), Domain::Periodic(cell_box), model)?;
    /// simulation.step(0.01)?;
    /// simulation.replace_cells(simulation.positions()[1..].to_vec(), Vec::new())?;
    /// assert_eq!(simulation.velocities().len(), 35);
    /// assert_eq!(simulation.time(), 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn replace_cells(&mut self, mut positions: Vec<Vector<S>>, headings: Vec<S>) -> Result<(), Error> {
        let cells = positions.len();
        let directions = if self.driving.speed == 0.0 { 0 } else { cells };
        if headings.len() != directions {
            return Err(Error::State { cells, positions: cells, headings: headings.len() });
        }
        if !self.now.speeds.is_empty() {
            return Err(Error::FreeSpeed);
        }
        let time = self.now.time;
        let renewed = match self.walls() {
            Some(walls) => Mirrored::made(walls, &self.cell_box, &mut positions, |places, domain| {
                self.tessellation.exchanged(places, domain).map(|(next, _)| next)
            })
            .map(|(mirrored, tessellation)| (Some(mirrored), tessellation)),
            None => self
                .domain_at(time)
                .and_then(|domain| {
                    self.tessellation.exchanged(without_derivatives(&positions, &mut self.places), domain)
                })
                .map(|(tessellation, _)| (None, tessellation)),
        };
        (self.mirrored, self.tessellation) =
            renewed.map_err(|source| Error::Tessellation { time, source })?;
        self.spacing = (self.cell_box.area() / cells as f64).sqrt();
        (self.now.positions, self.now.headings) = (positions, headings);
        self.settle()
    }

    /// The same, with parameters of their own from now on.
    pub(crate) fn replace_cells_with(
        &mut self,
        positions: Vec<Vector<S>>,
        headings: Vec<S>,
        factors: Result<CellFactors, EnvironmentError>,
    ) -> Result<(), Error> {
        let environment = self.having(factors)?;
        let before = std::mem::replace(&mut self.model.environment, environment);
        let replaced = self.replace_cells(positions, headings);
        if replaced.is_err() {
            self.model.environment = before;
        }
        replaced
    }

    /// Cells have parameters of their own from now on.
    pub(crate) fn give_factors(
        &mut self,
        factors: Result<CellFactors, EnvironmentError>,
    ) -> Result<(), Error> {
        self.model.environment = self.having(factors)?;
        self.settle()
    }

    fn having(&self, factors: Result<CellFactors, EnvironmentError>) -> Result<Arc<Environment>, Error> {
        let environment = Environment::clone(&self.model.environment);
        (factors.and_then(|factors| environment.with_cell_factors(factors)))
            .map(Arc::new)
            .map_err(|source| Error::Environment { source })
    }
}
