//! From the units of the data to those of a fit.

use super::{Observation, Velocities};
use crate::flow::{Flow, Window};
use crate::median::median;
use crate::{Error, Scale};
use voronudge_geometry::{Domain, Grid, PeriodicBox, Vector};

impl Observation {
    /// The same positions, velocities, boundary and field of view in the units of a fit, judged anew; nothing else that was said of the
    /// observation. `frame` is used in messages.
    ///
    /// # Errors
    /// [`Error::Geometry`] if the scale leads beyond what can be tessellated.
    pub fn scaled(&self, frame: usize, scale: &Scale) -> Result<Self, Error> {
        let beyond = |source| Error::Geometry { frame, source };
        let domain = match self.tessellation.domain() {
            Domain::Periodic(cell_box) => {
                let lengths = cell_box.lengths().map(|l| l / scale.length);
                let offset = cell_box.offset() / scale.length;
                Domain::Periodic(PeriodicBox::sheared(lengths, offset).map_err(beyond)?)
            }
            Domain::Open => Domain::Open,
        };
        let positions = self.positions.iter().map(|r| r / scale.length).collect();
        let velocities = match &self.velocities {
            Velocities::OfCells(all) => {
                Velocities::OfCells(all.iter().map(|v| v.map(|v| v / scale.velocity())).collect())
            }
            Velocities::OnGrid(flow) => Velocities::OnGrid(flow.scaled(scale).map_err(beyond)?),
        };
        let field_of_view = self.field_of_view.scaled(scale.length.recip());
        Self::new(frame, positions, velocities, domain, field_of_view)
    }

    /// Removes the median of the velocities to be explained, component by component, from all: drift of the stage shows as one. The median does
    /// not follow a few fast cells.
    pub fn remove_median(&mut self) {
        let median = |axis: usize| median(&mut self.targets().map(|(_, v)| v[axis]).collect::<Vec<f64>>());
        let (Some(x), Some(y)) = (median(0), median(1)) else { return };
        let drift = Vector::new(x, y);
        self.velocities.values_mut().iter_mut().flatten().for_each(|v| *v -= drift);
    }
}

impl Flow {
    /// The same flow in the units of a fit.
    ///
    /// # Errors
    /// Those of [`Grid::new`].
    pub fn scaled(&self, scale: &Scale) -> Result<Self, voronudge_geometry::Error> {
        let lengths = |lengths: [f64; 2]| lengths.map(|length| length / scale.length);
        let origin = self.grid.centre(0);
        Ok(Self {
            grid: Grid::new(lengths([origin.x, origin.y]), lengths(self.grid.spacing()), self.grid.size())?,
            velocities: self.velocities.iter().map(|v| v.map(|v| v / scale.velocity())).collect(),
            window: Window { width: self.window.width / scale.length, ..self.window },
        })
    }
}
