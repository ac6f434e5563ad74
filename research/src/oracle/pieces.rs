//! Polygons corner by corner, and forces on them handed to the centres: what further effects are computed from.

use super::{Oracle, length, unit, vertex_derivative};
use nalgebra::Vector2;

/// A vertex as one of the polygons that share it sees it.
pub struct Corner {
    /// Whose polygon.
    pub cell: usize,
    /// `A` of that polygon.
    pub area: f64,
    /// `P` of that polygon.
    pub perimeter: f64,
    /// Number of its sides.
    pub sides: usize,
    /// The vertex before, counter-clockwise.
    pub before: Vector2<f64>,
    /// The vertex.
    pub here: Vector2<f64>,
    /// The vertex after.
    pub after: Vector2<f64>,
    /// `∂A/∂r_v`
    pub of_area: Vector2<f64>,
    /// `∂P/∂r_v`
    pub of_perimeter: Vector2<f64>,
}

impl Oracle {
    /// Velocities of the centres under forces on vertices: `Σ_v (∂r_v/∂r_i)ᵀ f_v`, with `f_v` the sum of what the
    /// polygons that share the vertex contribute.
    pub fn pull_back(&self, force: impl Fn(&Corner) -> Vector2<f64>) -> Vec<Vector2<f64>> {
        let mut velocities = vec![Vector2::zeros(); self.positions.len()];
        for cell in 0..self.positions.len() {
            for (m, corner) in self.corners(cell).iter().enumerate() {
                let f = force(corner);
                let (side, next) = (self.sides[cell][m], self.sides[cell][(m + 1) % corner.sides]);
                let owners = [cell, side.cell, next.cell];
                let positions = &self.positions;
                let centres = [positions[cell], self.centre(positions, side), self.centre(positions, next)];
                for k in 0..3 {
                    let rotated = [0, 1, 2].map(|j| centres[(k + j) % 3]);
                    velocities[owners[k]] += vertex_derivative(rotated, corner.here).transpose() * f;
                }
            }
        }
        velocities
    }

    /// The cells on the other side of each side of a cell's polygon, with the way from its centre to theirs.
    pub fn neighbours(&self, cell: usize) -> Vec<(usize, Vector2<f64>)> {
        let here = self.positions[cell];
        self.sides[cell].iter().map(|&s| (s.cell, self.centre(&self.positions, s) - here)).collect()
    }

    /// The corners of a cell's polygon, counter-clockwise.
    fn corners(&self, cell: usize) -> Vec<Corner> {
        let vertices = self.vertices(&self.positions, cell);
        let sides = vertices.len();
        let (mut area, mut perimeter) = (0.0, 0.0);
        for (m, p) in vertices.iter().enumerate() {
            let q = vertices[(m + 1) % sides];
            area += 0.5 * (p.x * q.y - q.x * p.y);
            perimeter += length(q - p);
        }
        let corner = |m: usize| {
            let (before, here, after) =
                (vertices[(m + sides - 1) % sides], vertices[m], vertices[(m + 1) % sides]);
            Corner {
                cell,
                area,
                perimeter,
                sides,
                before,
                here,
                after,
                of_area: Vector2::new(after.y - before.y, before.x - after.x) * 0.5,
                of_perimeter: unit(here - before) + unit(here - after),
            }
        };
        (0..sides).map(corner).collect()
    }
}
