//! Part of an observation.

use crate::{Error, Observation};
use std::sync::Arc;
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
        let mut own = Self { used: vec![true; cells.len()], ..whole }.being(self, cells);
        // Cells that are held are where the nudges have put them.
        for ((aim, &cell), _) in own.aims.iter_mut().zip(cells).zip(&held).filter(|(_, held)| **held) {
            *aim -= Vector::new(nudges[2 * cell], nudges[2 * cell + 1]);
        }
        Ok(Self { held, ..own })
    }

    /// Some cells of this one, as if no others had been seen.
    pub(crate) fn excerpt(&self, cells: &[usize]) -> Result<Self, Error> {
        let positions = cells.iter().map(|cell| self.positions[*cell]).collect();
        let targets: Vec<_> = cells.iter().map(|cell| self.target(*cell)).collect();
        let mut own =
            Self::new(0, positions, targets, Domain::Open, FieldOfView::default())?.being(self, cells);
        let is_certain = |own: &Self, cell: usize| own.visibility[cell].has_certain_polygon();
        own.polygons =
            (0..cells.len()).map(|cell| own.may_have_polygon(cell) && is_certain(&own, cell)).collect();
        Ok(own.with_background(self.background_degree()))
    }

    /// What is known of some cells of another observation, where these are.
    fn being(self, other: &Self, cells: &[usize]) -> Self {
        fn own<T: Copy>(of_cells: &[T], cells: &[usize]) -> Vec<T> {
            if of_cells.is_empty() { Vec::new() } else { cells.iter().map(|cell| of_cells[*cell]).collect() }
        }
        let aims = match other.aims.is_empty() && other.share == 0.0 {
            true => Vec::new(),
            false => cells.iter().map(|cell| other.aim(*cell)).collect(),
        };
        Self {
            stiffness: own(&other.stiffness, cells),
            weights: own(&other.weights, cells),
            polygons: own(&other.polygons, cells),
            share: other.share,
            aims,
            environment: Arc::new(other.environment.of_cells(cells)),
            ..self
        }
    }
}
