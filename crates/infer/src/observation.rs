//! One snapshot: where the cells are and how fast they move.

use crate::Error;
use voronudge_geometry::{Domain, FieldOfView, Tessellation, Vector, Visibility};

/// Cells of one frame with their tessellation as measured. Cells are those present in the frame, in any order.
#[derive(Debug, Clone)]
pub struct Observation {
    /// Cell centres (N).
    pub positions: Vec<Vector<f64>>,
    /// Measured velocities (N); `None` where there is none.
    pub velocities: Vec<Option<Vector<f64>>>,
    /// Tessellation of the measured positions.
    pub tessellation: Tessellation,
    /// Whether a cell can be trusted (open fields of view).
    pub visibility: Vec<Visibility>,
}

impl Observation {
    /// Tessellates a snapshot. `largest_area` is the multiple of the median area above which an open field's polygon is
    /// taken for a rim or a hole. `frame` is used in messages.
    ///
    /// # Errors
    /// [`Error::Lengths`], [`Error::Geometry`].
    pub fn new(
        frame: usize,
        positions: Vec<Vector<f64>>,
        velocities: Vec<Option<Vector<f64>>>,
        domain: Domain,
        largest_area: f64,
    ) -> Result<Self, Error> {
        if positions.len() != velocities.len() {
            return Err(Error::Lengths { frame, positions: positions.len(), velocities: velocities.len() });
        }
        let tessellation =
            Tessellation::new(&positions, domain).map_err(|source| Error::Geometry { frame, source })?;
        let visibility = FieldOfView::new(&tessellation, &positions, largest_area).visibility().to_vec();
        Ok(Self { positions, velocities, tessellation, visibility })
    }

    /// The velocity to be explained: of a trusted cell whose velocity was measured.
    pub fn target(&self, cell: usize) -> Option<Vector<f64>> {
        self.velocities[cell].filter(|_| self.visibility[cell] == Visibility::Counted)
    }

    /// The cells with a target, and their targets.
    pub fn targets(&self) -> impl Iterator<Item = (usize, Vector<f64>)> {
        (0..self.positions.len()).filter_map(|cell| Some((cell, self.target(cell)?)))
    }
}
