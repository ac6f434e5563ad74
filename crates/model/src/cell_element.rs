//! What a general term sees of a cell, and where it puts its forces.

use crate::Environment;
use voronudge_geometry::{Arithmetic, CellPolygon, Domain, Elementary, Vector, dot};

/// One cell with its ring, as a [`RingTerm`](crate::RingTerm) sees it.
#[derive(Debug, Clone, Copy)]
pub struct CellElement<'a, S> {
    /// Index of the cell.
    pub cell: usize,
    /// Its neighbours, in the order of the ring.
    pub neighbours: &'a [u32],
    /// The ring and the polygon, relative to the cell.
    pub polygon: &'a CellPolygon<S>,
    /// Position of the cell.
    pub position: Vector<S>,
    /// The boundary condition.
    pub domain: Domain,
    /// What surrounds and preceded the cells.
    pub environment: &'a Environment,
}

impl<S: Elementary> CellElement<'_, S> {
    /// Position of the cell relative to the environment's origin.
    pub fn from_origin(&self) -> Vector<S> {
        from_origin(self.position, self.environment)
    }

    /// Length of side `m` and the unit vector along it, counter-clockwise.
    pub fn side(&self, m: usize) -> (S, Vector<S>) {
        let corners = self.polygon.corners();
        let before = if m == 0 { corners.len() - 1 } else { m - 1 };
        let direction = self.polygon.directions()[m];
        (dot(corners[m].centre - corners[before].centre, direction), direction)
    }

    /// Unit vector to each neighbour and distance of it.
    pub fn directions(&self) -> impl Iterator<Item = (Vector<S>, S)> {
        self.polygon.ring().iter().map(|d| {
            let distance = dot(*d, *d).root();
            (*d * distance.inverse(), distance)
        })
    }
}

/// Where a cell is, how many neighbours it has, and what is known of it.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a, S> {
    /// Index of the cell.
    pub cell: usize,
    /// Number of its neighbours.
    pub neighbours: usize,
    /// Position of the cell.
    pub position: Vector<S>,
    /// What surrounds and preceded the cells.
    pub environment: &'a Environment,
}

impl<S: Arithmetic> Site<'_, S> {
    /// Position of the cell relative to the environment's origin.
    pub fn from_origin(&self) -> Vector<S> {
        from_origin(self.position, self.environment)
    }
}

fn from_origin<S: Arithmetic>(position: Vector<S>, environment: &Environment) -> Vector<S> {
    let origin = environment.origin();
    Vector::new(position.x - origin.x, position.y - origin.y)
}

/// The forces of one cell on its ring and on itself.
#[derive(Debug)]
pub struct RingForces<'a, S> {
    /// On the neighbours, in the order of the ring.
    pub(crate) on_ring: &'a mut [Vector<S>],
    /// On the cell itself.
    pub(crate) on_cell: &'a mut Vector<S>,
}

impl<S: Arithmetic> RingForces<'_, S> {
    /// A force on the cell itself: from outside, momentum is not conserved.
    pub fn on_cell(&mut self, force: Vector<S>) {
        *self.on_cell += force;
    }

    /// A force on neighbour `m`, and its opposite on the cell. Half of the force of a pair, because both cells add one.
    pub fn on_pair(&mut self, m: usize, force: Vector<S>) {
        self.on_ring[m] += force;
        *self.on_cell -= force;
    }

    /// A force on vertex `m` of the polygon, handed on to the two neighbours there and to the cell.
    pub fn on_vertex(&mut self, polygon: &CellPolygon<S>, m: usize, force: Vector<S>) {
        let next = if m + 1 == self.on_ring.len() { 0 } else { m + 1 };
        let [on_this, on_next] = polygon.corners()[m].pull_back(force);
        self.on_ring[m] += on_this;
        self.on_ring[next] += on_next;
        *self.on_cell -= on_this + on_next;
    }

    /// The same force law at every vertex, by its index.
    pub fn on_vertices(&mut self, polygon: &CellPolygon<S>, force: impl Fn(usize) -> Vector<S>) {
        for m in 0..polygon.len() {
            self.on_vertex(polygon, m, force(m));
        }
    }
}
