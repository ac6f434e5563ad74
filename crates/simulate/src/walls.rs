//! Torque-free walls: mirror images of the cells.

use crate::scaled::without_derivatives;
use crate::{Driving, Error};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Scalar, Tessellation, Vector};
use voronudge_model::Model;

/// Straight walls without friction or torque at the sides of the box.
///
/// Cells beside a wall meet the mirror images of themselves and of their neighbours, so the wall is made of sides of cells. Vertices on
/// it slide along it: forces along the wall are handed to the cells as anywhere, forces across it the wall takes up. A box that is twice as large in each walled direction, filled by
/// the cells and their images, is periodic, so that everything else is as in a periodic box. Without chirality velocities are
/// `−∂E/∂r_i` with the energy of the cells between the walls.
///
/// The paper (SI, "Details of numerical simulations") has the mirror images, but leaves the vertices on the wall out of the equation of
/// motion. At a row of regular hexagons the wall then takes up the whole prestress torque: see `docs/corrections.md`, "Torque-free walls".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Walls {
    /// At `x = 0` and `x = L_x`; periodic in y: a channel.
    X,
    /// On all four sides.
    Both,
}

impl Walls {
    /// The axes across which there are walls: mirror `k` reverses component `mirrors()[k]`.
    pub fn mirrors(self) -> &'static [usize] {
        match self {
            Self::X => &[0],
            Self::Both => &[0, 1],
        }
    }

    /// Images of a cell, itself included.
    pub fn images(self) -> usize {
        1 << self.mirrors().len()
    }

    /// Whether cells can move between walls under a model: its terms are functions of the cells' shapes.
    pub fn admit<S: Scalar>(self, model: &Model<S>) -> bool {
        model.is_of_shapes() && model.responses.is_empty()
    }

    /// Cells in front of the walls of a box at positions (N) with velocities (N, or none): the tessellation of them and their mirror images, and
    /// the positions and velocities of all, the cells themselves first.
    ///
    /// # Errors
    /// As [`Tessellation::new`].
    pub fn with_images(
        self,
        cell_box: &PeriodicBox,
        positions: &[Vector<f64>],
        velocities: &[Vector<f64>],
    ) -> Result<CellsAndImages, voronudge_geometry::Error> {
        let mut front = positions.to_vec();
        let (mirrored, tessellation) = Mirrored::of(self, cell_box, &mut front)?;
        let mut all = velocities.to_vec();
        mirrored.unfold(&mut all);
        for &axis in self.mirrors() {
            for index in 0..all.len() {
                let mut image = all[index];
                image[axis] = -image[axis];
                all.push(image);
            }
        }
        let tessellation = tessellation.tessellation().clone();
        Ok(CellsAndImages { tessellation, positions: mirrored.positions, velocities: all })
    }

    /// The periodic box of cells and images.
    fn doubled(self, mut lengths: [f64; 2]) -> Result<PeriodicBox, voronudge_geometry::Error> {
        self.mirrors().iter().for_each(|&axis| lengths[axis] *= 2.0);
        PeriodicBox::new(lengths)
    }
}

/// Cells between walls and their mirror images at one time.
#[derive(Debug, Clone)]
pub struct CellsAndImages {
    /// Of all, in a box twice as large in each walled direction.
    pub tessellation: Tessellation,
    /// Positions, the cells themselves first.
    pub positions: Vec<Vector<f64>>,
    /// Velocities, in the same order.
    pub velocities: Vec<Vector<f64>>,
}

/// Cells between walls, with their mirror images.
#[derive(Debug, Clone)]
pub(crate) struct Mirrored<S: Scalar> {
    pub walls: Walls,
    lengths: [f64; 2],
    /// All images, the cells themselves first.
    pub positions: Vec<Vector<S>>,
    /// Sign of each component of each cell: negative where the cell was found behind a wall.
    signs: Vec<[f64; 2]>,
}

impl<S: Scalar> Mirrored<S> {
    /// Cells at positions, which are put in front of the walls, and the tessellation of them and their images.
    pub fn of(
        walls: Walls,
        cell_box: &PeriodicBox,
        positions: &mut [Vector<S>],
    ) -> Result<(Self, MovingTessellation), voronudge_geometry::Error> {
        Self::made(walls, cell_box, positions, MovingTessellation::new)
    }

    /// The same, tessellated in some way.
    pub fn made(
        walls: Walls,
        cell_box: &PeriodicBox,
        positions: &mut [Vector<S>],
        tessellate: impl FnOnce(&[Vector<f64>], Domain) -> Result<MovingTessellation, voronudge_geometry::Error>,
    ) -> Result<(Self, MovingTessellation), voronudge_geometry::Error> {
        let lengths = cell_box.lengths();
        let mut mirrored = Self { walls, lengths, positions: Vec::new(), signs: Vec::new() };
        mirrored.place(positions);
        let domain = Domain::Periodic(walls.doubled(lengths)?);
        let tessellation = tessellate(without_derivatives(&mirrored.positions, &mut Vec::new()), domain)?;
        positions.copy_from_slice(&mirrored.positions[..positions.len()]);
        Ok((mirrored, tessellation))
    }

    /// The walls for cells of other scalars, of which none are placed yet.
    pub fn carried_over<T: Scalar>(&self) -> Mirrored<T> {
        Mirrored { walls: self.walls, lengths: self.lengths, positions: Vec::new(), signs: Vec::new() }
    }

    /// Places cells and images. A cell behind a wall is put where its image is, in front of it.
    pub fn place(&mut self, positions: &[Vector<S>]) {
        self.signs.clear();
        self.positions.clear();
        for r in positions {
            let mut placed = *r;
            let mut sign = [1.0; 2];
            for &axis in self.walls.mirrors() {
                let (within, direction) = fold(r[axis].real(), self.lengths[axis]);
                placed[axis] = (r[axis] - r[axis].real()) * direction + within;
                sign[axis] = direction;
            }
            self.positions.push(placed);
            self.signs.push(sign);
        }
        for &axis in self.walls.mirrors() {
            for index in 0..self.positions.len() {
                let mut image = self.positions[index];
                image[axis] = -image[axis];
                self.positions.push(image);
            }
        }
    }

    /// Velocities of the cells in front of the walls as those of the cells where they were given.
    pub fn unfold(&self, velocities: &mut [Vector<S>]) {
        for (v, sign) in velocities.iter_mut().zip(&self.signs) {
            *v = Vector::new(v.x * sign[0], v.y * sign[1]);
        }
    }

    /// Puts cells that were placed last in front of the walls, and their velocities; returns how many were behind one.
    pub fn bring_back(&self, positions: &mut [Vector<S>], velocities: &mut [Vector<S>]) -> u64 {
        self.unfold(velocities);
        positions.copy_from_slice(&self.positions[..positions.len()]);
        self.signs.iter().filter(|sign| sign[0] < 0.0 || sign[1] < 0.0).count() as u64
    }

    /// The walls that a cell touches, as it meets its own image there: directions along them, anticlockwise around the box.
    fn tangents<'a>(
        &'a self,
        tessellation: &'a Tessellation,
        cell: usize,
    ) -> impl Iterator<Item = Vector<f64>> + 'a {
        let (cells, r) = (self.signs.len(), self.positions[cell]);
        self.walls.mirrors().iter().enumerate().filter_map(move |(bit, &axis)| {
            let own_image = cell + (cells << bit);
            if !tessellation.neighbours(cell).contains(&(own_image as u32)) {
                return None;
            }
            let far = if r[axis].real() > 0.5 * self.lengths[axis] { 1.0 } else { -1.0 };
            // Up at the right wall, to the left at the upper one.
            Some(if axis == 0 { Vector::new(0.0, far) } else { Vector::new(-far, 0.0) })
        })
    }

    /// Mean tangential velocity of the cells that touch a wall.
    pub fn edge_velocity(&self, tessellation: &Tessellation, velocities: &[Vector<S>]) -> Option<S> {
        let (mut sum, mut count) = (S::constant(0.0), 0.0);
        for (cell, v) in velocities.iter().enumerate() {
            for tangent in self.tangents(tessellation, cell) {
                sum += v.x * tangent.x + v.y * tangent.y;
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum / count)
    }
}

/// The place of a coordinate between mirrors at 0 and `length`, and the sign of its direction there.
pub(crate) fn fold(x: f64, length: f64) -> (f64, f64) {
    if (0.0..=length).contains(&x) {
        return (x, 1.0);
    }
    let within = x.rem_euclid(2.0 * length);
    if within <= length { (within, 1.0) } else { (2.0 * length - within, -1.0) }
}

/// Walls need forces that are defined by the shapes of cells alone.
pub(crate) fn check<S: Scalar>(
    walls: Walls,
    model: &Model<S>,
    cell_box: &PeriodicBox,
    driving: &Driving,
) -> Result<(), Error> {
    let reason = if cell_box.offset() != 0.0 || driving.shear.is_some() {
        "the box is sheared"
    } else if driving.speed != 0.0 {
        "cells propel themselves"
    } else if !walls.admit(model) {
        "the model has effects that are not functions of the cells' shapes"
    } else {
        return Ok(());
    };
    Err(Error::Walls { reason })
}
