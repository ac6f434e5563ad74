//! A slow second implementation of the model, to check the first one against.
//!
//! It shares no code with the crates of the workspace and takes another way wherever there is one:
//!
//! - Voronoi polygons by cutting a large square with the bisector of every image of every cell, no triangulation;
//! - vertices by the determinant formula for three points in absolute coordinates;
//! - areas by the shoelace formula and perimeters by the distances of vertices, with the gradients of both written for
//!   vertices: `∂A/∂r_m = ½ (y_{m+1} − y_{m−1}, x_{m−1} − x_{m+1})` and
//!   `∂P/∂r_m = u(r_m − r_{m−1}) + u(r_m − r_{m+1})` with unit vectors `u`;
//! - motion of vertices with centres by solving the two bisector equations, differentiated, as a 2 × 2 system;
//! - the Jacobian column by column, each a dual evaluation of the whole system;
//! - its eigenvalues by the QR algorithm of another library.
//!
//! Positions must be generic: no two vertices of a polygon at one place.

mod pieces;
mod polygon;

use nalgebra::{DMatrix, Matrix2, Vector2};
use num_dual::{Dual64, DualNumCopy};
pub use pieces::Corner;
use polygon::Side;

/// A real or dual number.
pub trait Number: DualNumCopy<Primitive = f64> {}
impl<T: DualNumCopy<Primitive = f64>> Number for T {}

/// Parameters of the base model, as plain numbers.
#[derive(Debug, Clone, Copy)]
pub struct Constants {
    /// `K_A`
    pub area_elasticity: f64,
    /// `K_P`
    pub perimeter_elasticity: f64,
    /// `P_0`
    pub preferred_perimeter: f64,
    /// `A_0`
    pub preferred_area: f64,
    /// `α`
    pub chirality: f64,
}

/// Cells in a periodic box with their Voronoi polygons.
pub struct Oracle {
    lengths: [f64; 2],
    positions: Vec<Vector2<f64>>,
    /// Sides of each cell's polygon, counter-clockwise.
    sides: Vec<Vec<Side>>,
}

/// Everything the model says about a configuration.
pub struct Fields<S> {
    /// `A_i`
    pub areas: Vec<S>,
    /// `P_i`
    pub perimeters: Vec<S>,
    /// `v_i`
    pub velocities: Vec<Vector2<S>>,
    /// Mean stress, force index first.
    pub stress: [[S; 2]; 2],
}

impl Oracle {
    /// Finds the polygons of cells at `positions` in a box with the given side lengths.
    pub fn new(positions: &[Vector2<f64>], lengths: [f64; 2]) -> Self {
        let sides = (0..positions.len()).map(|cell| polygon::sides(positions, lengths, cell)).collect();
        Self { lengths, positions: positions.to_vec(), sides }
    }

    /// Length of the shortest side of any polygon: how generic the positions are.
    pub fn shortest_side(&self) -> f64 {
        let positions = &self.positions;
        let lengths = (0..positions.len()).flat_map(|cell| {
            let vertices = self.vertices(positions, cell);
            (0..vertices.len()).map(move |m| (vertices[m] - vertices[(m + 1) % vertices.len()]).norm())
        });
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// Areas, perimeters, velocities and stress.
    pub fn fields(&self, constants: &Constants) -> Fields<f64> {
        self.fields_at(&self.positions, constants)
    }

    /// `∂v/∂r`, 2N rows in the order x₀, y₀, x₁, …, at frozen polygons.
    pub fn jacobian(&self, constants: &Constants) -> Vec<Vec<f64>> {
        let n = 2 * self.positions.len();
        let mut rows = vec![vec![0.0; n]; n];
        let constant = |r: &Vector2<f64>| r.map(Dual64::from_re);
        for column in 0..n {
            let mut positions: Vec<_> = self.positions.iter().map(constant).collect();
            let seeded = &mut positions[column / 2][column % 2];
            *seeded = seeded.derivative();
            let velocities = self.fields_at(&positions, constants).velocities;
            for (row, entry) in velocities.iter().flat_map(|v| [v.x.eps, v.y.eps]).enumerate() {
                rows[row][column] = entry;
            }
        }
        rows
    }

    /// Eigenvalues of the Jacobian (real, imaginary) by another library than the program's, the largest real part first.
    pub fn eigenvalues(&self, constants: &Constants) -> Vec<[f64; 2]> {
        let rows = self.jacobian(constants);
        let matrix = DMatrix::from_fn(rows.len(), rows.len(), |row, column| rows[row][column]);
        let mut values: Vec<[f64; 2]> = matrix.complex_eigenvalues().iter().map(|v| [v.re, v.im]).collect();
        values.sort_by(|a, b| b[0].total_cmp(&a[0]).then(b[1].total_cmp(&a[1])));
        values
    }

    fn fields_at<S: Number>(&self, positions: &[Vector2<S>], constants: &Constants) -> Fields<S> {
        let zero = S::from(0.0);
        let mut fields = Fields {
            areas: Vec::new(),
            perimeters: Vec::new(),
            velocities: vec![Vector2::new(zero, zero); positions.len()],
            stress: [[zero; 2]; 2],
        };
        for cell in 0..positions.len() {
            self.add_cell(positions, cell, constants, &mut fields);
        }
        let box_area = self.lengths[0] * self.lengths[1];
        fields.stress = fields.stress.map(|row| row.map(|entry| -entry / box_area));
        fields
    }

    fn add_cell<S: Number>(
        &self,
        positions: &[Vector2<S>],
        cell: usize,
        constants: &Constants,
        fields: &mut Fields<S>,
    ) {
        let vertices = self.vertices(positions, cell);
        let count = vertices.len();
        let (mut area, mut perimeter) = (S::from(0.0), S::from(0.0));
        for m in 0..count {
            let (p, q) = (vertices[m], vertices[(m + 1) % count]);
            area += (p.x * q.y - q.x * p.y) * 0.5;
            perimeter += length(q - p);
        }
        let pressure = (area - constants.preferred_area) * constants.area_elasticity;
        let tension = (perimeter - constants.preferred_perimeter) * constants.perimeter_elasticity;
        let torque = perimeter * constants.perimeter_elasticity * constants.chirality;
        for m in 0..count {
            let (before, here, after) =
                (vertices[(m + count - 1) % count], vertices[m], vertices[(m + 1) % count]);
            let of_area = Vector2::new((after.y - before.y) * 0.5, (before.x - after.x) * 0.5);
            let of_perimeter = unit(here - before) + unit(here - after);
            let force = Vector2::new(
                -pressure * of_area.x - tension * of_perimeter.x - torque * of_perimeter.y,
                -pressure * of_area.y - tension * of_perimeter.y + torque * of_perimeter.x,
            );
            let (next, side) = (self.sides[cell][(m + 1) % count], self.sides[cell][m]);
            let owners = [cell, side.cell, next.cell];
            let centres = [positions[cell], self.centre(positions, side), self.centre(positions, next)];
            for corner in 0..3 {
                let rotated = [0, 1, 2].map(|k| centres[(corner + k) % 3]);
                let slope = vertex_derivative(rotated, here);
                let pulled_back = slope.transpose() * force;
                fields.velocities[owners[corner]] += pulled_back;
                for (row, f) in [pulled_back.x, pulled_back.y].into_iter().enumerate() {
                    fields.stress[row][0] += f * centres[corner].x;
                    fields.stress[row][1] += f * centres[corner].y;
                }
            }
        }
        fields.areas.push(area);
        fields.perimeters.push(perimeter);
    }

    /// Vertex `m` lies between sides `m` and `m + 1`.
    fn vertices<S: Number>(&self, positions: &[Vector2<S>], cell: usize) -> Vec<Vector2<S>> {
        let sides = &self.sides[cell];
        (0..sides.len())
            .map(|m| {
                let (b, c) = (sides[m], sides[(m + 1) % sides.len()]);
                circumcentre(positions[cell], self.centre(positions, b), self.centre(positions, c))
            })
            .collect()
    }

    fn centre<S: Number>(&self, positions: &[Vector2<S>], side: Side) -> Vector2<S> {
        let r = positions[side.cell];
        Vector2::new(
            r.x + f64::from(side.image[0]) * self.lengths[0],
            r.y + f64::from(side.image[1]) * self.lengths[1],
        )
    }
}

/// Circumcentre of three points by determinants.
fn circumcentre<S: Number>(a: Vector2<S>, b: Vector2<S>, c: Vector2<S>) -> Vector2<S> {
    let square = |p: Vector2<S>| p.x * p.x + p.y * p.y;
    let d = (a.x * (b.y - c.y) + b.x * (c.y - a.y) + c.x * (a.y - b.y)) * 2.0;
    Vector2::new(
        (square(a) * (b.y - c.y) + square(b) * (c.y - a.y) + square(c) * (a.y - b.y)) / d,
        (square(a) * (c.x - b.x) + square(b) * (a.x - c.x) + square(c) * (b.x - a.x)) / d,
    )
}

/// `∂v/∂a` of the vertex `v` of centres a, b, c: the equations `(b − a)·v = (b² − a²)/2` and
/// `(c − a)·v = (c² − a²)/2`, differentiated, are `[(b − a)ᵀ; (c − a)ᵀ] ∂v/∂a = [(v − a)ᵀ; (v − a)ᵀ]`.
fn vertex_derivative<S: Number>([a, b, c]: [Vector2<S>; 3], v: Vector2<S>) -> Matrix2<S> {
    let (p, q, w) = (b - a, c - a, v - a);
    let determinant = p.x * q.y - p.y * q.x;
    let solve = |right: S| {
        Vector2::new((right * q.y - p.y * right) / determinant, (p.x * right - right * q.x) / determinant)
    };
    let (first, second) = (solve(w.x), solve(w.y));
    Matrix2::new(first.x, second.x, first.y, second.y)
}

fn length<S: Number>(d: Vector2<S>) -> S {
    (d.x * d.x + d.y * d.y).sqrt()
}

fn unit<S: Number>(d: Vector2<S>) -> Vector2<S> {
    let length = length(d);
    Vector2::new(d.x / length, d.y / length)
}

#[cfg(test)]
mod tests;
