//! Forces between cells, and where they act.

use super::Simulation;
use crate::Error;
use std::borrow::Cow;
use voronudge_geometry::{Scalar, Vector};
use voronudge_model::HalfEdgeForces;

/// A force between two places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bond<S: Scalar = f64> {
    /// Where one end is.
    pub from: Vector<S>,
    /// Where the other end is, relative to it.
    pub to: Vector<S>,
    /// The force on the other end; its opposite acts on the first.
    pub force: Vector<S>,
}

impl<S: Scalar> Simulation<S> {
    /// The same, which keeps the forces for [`Simulation::bonds`], where these are asked for after each step.
    pub(crate) fn keeping_bonds(mut self) -> Result<Self, Error> {
        self.forces = Some(HalfEdgeForces::default());
        self.settle()?;
        Ok(self)
    }

    /// The force of each cell's element on each of its neighbours; the opposite force acts on the cell. Between walls of the cells, not
    /// of their images.
    pub fn bonds(&self) -> Vec<Bond<S>> {
        let mut bonds = Vec::new();
        self.put_bonds(&mut bonds);
        bonds
    }

    /// The same in place of others.
    pub(crate) fn put_bonds(&self, bonds: &mut Vec<Bond<S>>) {
        let (tessellation, positions) = (self.tessellation(), self.positions_with_images());
        let forces = match &self.forces {
            Some(kept) => Cow::Borrowed(kept),
            None => Cow::Owned(HalfEdgeForces::of(tessellation, positions, &self.model)),
        };
        bonds.clear();
        for (cell, &from) in self.now.positions.iter().enumerate() {
            let displacements = tessellation.displacements(positions, cell);
            let sides = tessellation.ring(cell).zip(displacements);
            bonds.extend(sides.map(|(h, to)| Bond { from, to, force: forces.on_neighbour(h) }));
        }
    }
}
