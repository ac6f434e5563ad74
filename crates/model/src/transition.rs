//! By how much velocities jump in a T1 transition.
//!
//! The forces along the gradients of perimeters depend on the directions of the sides that end at a vertex, also of one that has no length.
//! Where a side vanishes and another appears, the velocities of the four cells there jump; all others are continuous.

use crate::assembly::element;
use crate::block_matrix::Block;
use crate::element_jacobian::{ElementJacobian, seeded};
use crate::{Model, VertexForces};
use voronudge_geometry::{CellPolygon, Tangent, Tessellation, Vector};

/// What a side and the one that would follow it mean to four cells: the two that it separates, then the two that it would join,
/// clockwise and counter-clockwise of it as seen from the first (the order of [`voronudge_geometry::Side::cells`]).
#[derive(Debug, Clone)]
pub struct Exchange {
    /// The four cells.
    pub cells: [usize; 4],
    /// Their rings as they are, and with the side exchanged.
    rings: [[Ring; 2]; 4],
}

/// Derivatives of the jumps of four cells by the positions of cells: for each of the four, cells and blocks `[xx, xy, yx, yy]`.
pub type JumpSlopes = [Vec<(u32, Block)>; 4];

/// A ring: displacements to the neighbours, counter-clockwise, and which of them are among the four cells.
#[derive(Debug, Clone)]
struct Ring {
    displacements: Vec<Vector<f64>>,
    neighbours: Vec<u32>,
    /// Index in the ring and number among the four.
    own: Vec<(usize, usize)>,
}

impl Ring {
    /// The same without a neighbour.
    fn without(&self, at: usize) -> Self {
        let mut ring = self.clone();
        ring.displacements.remove(at);
        ring.neighbours.remove(at);
        ring.own.retain(|(index, _)| *index != at);
        ring.own.iter_mut().filter(|(index, _)| *index > at).for_each(|(index, _)| *index -= 1);
        ring
    }

    /// The same with one of the four cells before a neighbour.
    fn with(&self, at: usize, cell: u32, number: usize, displacement: Vector<f64>) -> Self {
        let mut ring = self.clone();
        ring.displacements.insert(at, displacement);
        ring.neighbours.insert(at, cell);
        ring.own.iter_mut().filter(|(index, _)| *index >= at).for_each(|(index, _)| *index += 1);
        ring.own.push((at, number));
        ring
    }
}

impl Exchange {
    /// The exchange of the side that half-edge `h` of `cell` points across; positions may be any near those that have this side. `None` where
    /// a polygon is open.
    pub fn new(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: usize,
        h: usize,
    ) -> Option<Self> {
        let [before, after] = tessellation.opposite(cell, h)?;
        let cells =
            [cell, tessellation.neighbour(h), tessellation.neighbour(before), tessellation.neighbour(after)];
        let twins = [h, before, after].map(|h| tessellation.twin(h));
        let ring = |number: usize, own: &[(usize, usize)]| {
            let cell = cells[number];
            let first = tessellation.half_edge_start(cell);
            Ring {
                displacements: tessellation.displacements(positions, cell).collect(),
                neighbours: tessellation.neighbours(cell).to_vec(),
                own: own.iter().map(|(h, number)| (h - first, *number)).collect(),
            }
        };
        let [d_to_a, c_to_a] = [twins[1], twins[2]];
        // Counter-clockwise: d, b, c around a; c, a, d around b; a, b around c; b, a around d.
        let around_b = tessellation.opposite(cells[1], twins[0])?;
        let around_c = tessellation.opposite(cells[3], c_to_a)?;
        let around_d = tessellation.opposite(cells[2], d_to_a)?;
        let a = ring(0, &[(before, 2), (h, 1), (after, 3)]);
        let b = ring(1, &[(around_b[0], 3), (twins[0], 0), (around_b[1], 2)]);
        let d = ring(2, &[(around_d[0], 1), (d_to_a, 0)]);
        let c = ring(3, &[(c_to_a, 0), (around_c[1], 1)]);
        let index = |cell: usize, h: usize| h - tessellation.half_edge_start(cell);
        let [from_a_to_d, from_a_to_c] =
            [before, after].map(|h| tessellation.displacement(positions, cell, h));
        let d_to_c = from_a_to_c - from_a_to_d;
        let rings = [
            [a.clone(), a.without(index(cell, h))],
            [b.clone(), b.without(index(cells[1], twins[0]))],
            [d.clone(), d.with(index(cells[2], d_to_a), cells[3] as u32, 3, d_to_c)],
            [c.clone(), c.with(index(cells[3], c_to_a) + 1, cells[2] as u32, 2, -d_to_c)],
        ];
        Some(Self { cells, rings })
    }

    /// The velocities of the four cells after the exchange less those before, for each of some models, at the same positions, where the
    /// length of a side counts with its sign. Responses are left out.
    pub fn jumps(
        &self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        models: &[Model<f64>],
    ) -> Vec<[Vector<f64>; 4]> {
        let mut jumps = vec![[Vector::zeros(); 4]; models.len()];
        let (mut polygon, mut forces) = (CellPolygon::default(), Vec::new());
        for (number, (cell, rings)) in self.cells.iter().zip(&self.rings).enumerate() {
            for (ring, sign) in rings.iter().zip([-1.0, 1.0]) {
                polygon.fill_ring(ring.displacements.iter().copied());
                let (domain, r) = (tessellation.domain(), positions[*cell]);
                for (model, jump) in models.iter().zip(&mut jumps) {
                    forces.clear();
                    forces.resize(ring.displacements.len(), Vector::zeros());
                    let on_cell = element(model, *cell, &ring.neighbours, r, domain, &polygon, &mut forces);
                    jump[number] += on_cell * sign;
                    ring.own.iter().for_each(|(index, other)| jump[*other] += forces[*index] * sign);
                }
            }
        }
        jumps
    }

    /// The derivative of the jump of each of the four cells by the positions of cells. Those of terms that are
    /// more than functions of areas and perimeters are left out.
    pub fn slopes(&self, model: &Model<f64>) -> JumpSlopes {
        let mut slopes = JumpSlopes::default();
        let model = model.map(Tangent::held);
        let (mut polygon, mut jacobian) = (CellPolygon::default(), ElementJacobian::default());
        let mut blocks = Vec::new();
        for (number, (cell, rings)) in self.cells.iter().zip(&self.rings).enumerate() {
            for (ring, sign) in rings.iter().zip([-1.0, 1.0]) {
                let sides = ring.displacements.len();
                blocks.clear();
                blocks.resize(sides * sides, [0.0; 4]);
                polygon.fill_ring(ring.displacements.iter().copied());
                let multiples = VertexForces::of_cell(&model, *cell, seeded(polygon.shape()));
                jacobian.fill(&polygon, &multiples, &mut blocks);
                // What acts on the cell itself is minus the sum of what acts on its ring.
                let on_cell = (0..sides).map(|slot| (slot, number, -sign));
                for (slot, of, sign) in on_cell.chain(ring.own.iter().map(|(slot, of)| (*slot, *of, sign))) {
                    for (neighbour, block) in ring.neighbours.iter().zip(&blocks[slot * sides..]) {
                        add(&mut slopes[of], *neighbour, block, sign);
                        add(&mut slopes[of], *cell as u32, block, -sign);
                    }
                }
            }
        }
        slopes
    }
}

/// Adds a block times a factor to that of a cell.
fn add(slopes: &mut Vec<(u32, Block)>, cell: u32, block: &Block, factor: f64) {
    match slopes.iter_mut().find(|(own, _)| *own == cell) {
        Some((_, sum)) => sum.iter_mut().zip(block).for_each(|(sum, entry)| *sum += factor * entry),
        None => slopes.push((cell, block.map(|entry| factor * entry))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Parameters, velocities};
    use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Transition};

    /// Cells on their way, seen on both sides of each transition: the whole field's jump is that of the four cells.
    #[test]
    fn the_jump_is_that_of_the_velocities() {
        let place = |i: i32, t: f64| {
            let x = f64::from(i);
            let still =
                Vector::new(f64::from(i % 12) + 0.3 * x.sin(), f64::from(i / 12) + 0.3 * (2.0 * x).cos());
            still + Vector::new((3.0 * x).cos(), (5.0 * x).sin()) * t
        };
        let parameters = Parameters { chirality: 0.7, preferred_perimeter: 3.9, ..Parameters::default() };
        let model = Model::chiral_voronoi(&parameters);
        let models = std::slice::from_ref(&model);
        let domain = Domain::Periodic(PeriodicBox::new([12.0, 12.0]).unwrap());
        let [first, last]: [Vec<Vector<f64>>; 2] =
            [0.0, 0.05].map(|t| (0..144).map(|i| place(i, t)).collect());
        let mut moving = MovingTessellation::new(&first, domain).unwrap();
        let before = moving.tessellation().clone();
        moving.renew(&last).unwrap();
        let after = moving.tessellation();
        let found = Transition::between(&before, after);
        assert!(!found.is_empty());
        for positions in [&first, &last] {
            let [old, new] = [&before, after].map(|tessellation| velocities(tessellation, positions, &model));
            let mut rest: Vec<Vector<f64>> = new.iter().zip(&old).map(|(new, old)| new - old).collect();
            let size = rest.iter().map(|v| v.norm()).fold(0.0, f64::max);
            for transition in &found {
                let ((cell, h), (other, back)) = (transition.lost, transition.gained);
                let there = Exchange::new(&before, positions, cell, h).unwrap();
                let [jump] = there.jumps(&before, positions, models)[..] else { panic!() };
                there.cells.iter().zip(jump).for_each(|(cell, jump)| rest[*cell] -= jump);
                let slopes = there.slopes(&model);
                let along = |cell: usize| Vector::new((1.3 * cell as f64).sin(), (0.7 * cell as f64).cos());
                let moved = |step: f64| {
                    let moved: Vec<Vector<f64>> =
                        positions.iter().enumerate().map(|(cell, r)| r + along(cell) * step).collect();
                    Exchange::new(&before, &moved, cell, h).unwrap().jumps(&before, &moved, models)[0]
                };
                let [less, more] = [-1e-6, 1e-6].map(moved);
                for (number, slopes) in slopes.iter().enumerate() {
                    let slope = slopes.iter().fold(Vector::zeros(), |sum: Vector<f64>, (cell, b)| {
                        let x = along(*cell as usize);
                        sum + Vector::new(b[0] * x.x + b[1] * x.y, b[2] * x.x + b[3] * x.y)
                    });
                    let difference = (more[number] - less[number]) / 2e-6;
                    assert!((slope - difference).norm() < 1e-6 * (1.0 + difference.norm()));
                }
                let again = Exchange::new(after, positions, other, back).unwrap();
                for (cell, reverse) in again.cells.iter().zip(again.jumps(after, positions, models)[0]) {
                    let number = there.cells.iter().position(|other| other == cell).unwrap();
                    assert!((jump[number] + reverse).norm() < 1e-12 * size);
                }
            }
            // What is left comes from perimeters, which change a little beyond the transition.
            assert!(size > 0.01 && rest.iter().all(|v| v.norm() < 0.2 * size));
        }
    }
}
