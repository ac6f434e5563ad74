//! By how much velocities jump in a T1 transition.
//!
//! The forces along the gradients of perimeters depend on the directions of the sides that end at a vertex, also of one that has no length.
//! Where a side vanishes and another appears, the velocities of the four cells there jump; all others are continuous.

use crate::block_matrix::Block;
use crate::element::element;
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
        let mut model = model.map(Tangent::held);
        model.terms.retain(|weighted| weighted.term.is_shape_term());
        let (mut polygon, mut jacobian) = (CellPolygon::default(), ElementJacobian::default());
        let mut blocks = Vec::new();
        for (number, (cell, rings)) in self.cells.iter().zip(&self.rings).enumerate() {
            for (ring, sign) in rings.iter().zip([-1.0, 1.0]) {
                let sides = ring.displacements.len();
                blocks.clear();
                blocks.resize(sides * sides, [0.0; 4]);
                polygon.fill_ring(ring.displacements.iter().copied());
                // Where a cell is makes no difference to shape terms.
                let site = model.site(*cell, sides, Tangent::held_vector(Vector::zeros()));
                let multiples = VertexForces::of_cell(&model, site, seeded(polygon.shape()));
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
