//! Part of an observation.

use crate::{Error, Observation};
use voronudge_geometry::{Domain, FieldOfView, Vector};

impl Observation {
    /// Some cells of this one, by their index, that are displaced by nudges of all cells, with positions of their own, the velocities that are to be explained, and those
    /// that are held.
    pub(crate) fn cut(
        &self,
        cells: &[usize],
        nudges: &[f64],
        positions: Vec<Vector<f64>>,
        targets: Vec<Option<Vector<f64>>>,
        held: Vec<bool>,
    ) -> Result<Self, Error> {
        let whole = Self::new(0, positions, targets, Domain::Open, FieldOfView::everywhere())?;
        let own = |of_cells: &[f64]| match of_cells.is_empty() {
            true => Vec::new(),
            false => cells.iter().map(|cell| of_cells[*cell]).collect(),
        };
        Ok(Self {
            used: vec![true; cells.len()],
            stiffness: own(&self.stiffness),
            share: self.share,
            aims: match self.aims.is_empty() && self.share == 0.0 {
                true => Vec::new(),
                // Cells that are held are where the nudges have put them.
                false => cells
                    .iter()
                    .zip(&held)
                    .map(|(&cell, held)| match held {
                        true => self.aim(cell) - Vector::new(nudges[2 * cell], nudges[2 * cell + 1]),
                        false => self.aim(cell),
                    })
                    .collect(),
            },
            polygons: match self.polygons.is_empty() {
                true => Vec::new(),
                false => cells.iter().map(|cell| self.polygons[*cell]).collect(),
            },
            held,
            weights: own(&self.weights),
            ..whole
        })
    }
}
