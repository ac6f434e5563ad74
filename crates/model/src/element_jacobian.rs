//! The exact derivative of one cell's element with respect to the positions of its ring.
//!
//! With the multiples `q = (q_A, q_P, q_T)` of the vertex forces held, what a corner transmits depends on its own two
//! neighbours and, through the area's gradient, linearly on the two vertices beside it. The multiples depend on the ring
//! through the cell's area and perimeter alone. So
//!
//! ```text
//! ∂g/∂d = ∂g/∂d |_q  +  Σ_{s ∈ {A, P}} ( ∂g/∂q · ∂q/∂s ) ⊗ ∂s/∂d
//! ```
//!
//! needs four dual directions for each corner and two for the terms, whatever the number of sides, through the very
//! formulas that give the forces.

use crate::{Model, VertexForces};
use num_dual::DualSVec64;
use voronudge_geometry::{CellPolygon, Corner, Shape, Vector, quarter_turn, side_direction};

type CornerDual = DualSVec64<4>;
type ShapeDual = DualSVec64<2>;

/// A block `[xx, xy, yx, yy]`, row = component of the force.
pub(crate) type Block = [f64; 4];

/// Buffers for the derivative of one element after another.
pub(crate) struct ElementJacobian {
    model: Model<ShapeDual>,
    polygon: CellPolygon<f64>,
    /// ∂c_m/∂d_m and ∂c_m/∂d_{m+1}
    vertex: Vec<[Block; 2]>,
    /// What a unit force along x, and along y, on vertex m transmits to neighbours m and m + 1, as ∂g/∂f.
    transmitted: Vec<[Block; 2]>,
    by_area: Gradient,
    by_perimeter: Gradient,
}

/// A shape's gradient `∂s/∂d`, and the derivative `∂g/∂q · ∂q/∂s` of the ring's forces by the shape.
#[derive(Default)]
struct Gradient {
    of_shape: Vec<Vector<f64>>,
    of_forces: Vec<Vector<f64>>,
}

impl Gradient {
    fn fill(&mut self, polygon: &CellPolygon<f64>, shape: &VertexForces<f64>, forces: &VertexForces<f64>) {
        self.of_shape.resize(polygon.len(), Vector::zeros());
        self.of_forces.resize(polygon.len(), Vector::zeros());
        shape.on_ring(polygon, &mut self.of_shape);
        forces.on_ring(polygon, &mut self.of_forces);
    }
}

fn derivative<const W: usize>(dual: &DualSVec64<W>, direction: usize) -> f64 {
    dual.eps.0.map_or(0.0, |eps| eps[direction])
}

impl ElementJacobian {
    pub(crate) fn new(model: &Model<f64>) -> Self {
        Self {
            model: model.lift(),
            polygon: CellPolygon::default(),
            vertex: Vec::new(),
            transmitted: Vec::new(),
            by_area: Gradient::default(),
            by_perimeter: Gradient::default(),
        }
    }

    /// Fills `∂g_a/∂d_b`, row-major in (a, b), for a cell and its ring of relative positions.
    pub(crate) fn fill(
        &mut self,
        cell: usize,
        ring: impl Iterator<Item = Vector<f64>>,
        blocks: &mut [Block],
    ) {
        self.polygon.fill_ring(ring);
        let Shape { area, perimeter } = self.polygon.shape();
        let forces = VertexForces::of_cell(
            &self.model,
            cell,
            Shape {
                area: ShapeDual::from_re(area).derivative(0),
                perimeter: ShapeDual::from_re(perimeter).derivative(1),
            },
        );
        let part = |pick: fn(&ShapeDual) -> f64| VertexForces {
            area: pick(&forces.area),
            perimeter: pick(&forces.perimeter),
            turned_perimeter: pick(&forces.turned_perimeter),
        };
        let unit = |area, perimeter| VertexForces { area, perimeter, turned_perimeter: 0.0 };
        self.by_area.fill(&self.polygon, &unit(1.0, 0.0), &part(|q| derivative(q, 0)));
        self.by_perimeter.fill(&self.polygon, &unit(0.0, 1.0), &part(|q| derivative(q, 1)));
        self.fill_by_shape(blocks);
        let held = part(|q| q.re);
        self.fill_corners(&held, blocks);
        self.fill_neighbouring_vertices(held.area, blocks);
    }

    fn fill_by_shape(&self, blocks: &mut [Block]) {
        let sides = self.polygon.len();
        for (a, row) in blocks.chunks_exact_mut(sides).enumerate() {
            let (by_area, by_perimeter) = (self.by_area.of_forces[a], self.by_perimeter.of_forces[a]);
            let gradients = self.by_area.of_shape.iter().zip(&self.by_perimeter.of_shape);
            for (block, (area, perimeter)) in row.iter_mut().zip(gradients) {
                *block = [
                    by_area.x * area.x + by_perimeter.x * perimeter.x,
                    by_area.x * area.y + by_perimeter.x * perimeter.y,
                    by_area.y * area.x + by_perimeter.y * perimeter.x,
                    by_area.y * area.y + by_perimeter.y * perimeter.y,
                ];
            }
        }
    }

    /// The dependence of each corner on its own two neighbours, with the vertices beside it held.
    fn fill_corners(&mut self, held: &VertexForces<f64>, blocks: &mut [Block]) {
        let sides = self.polygon.len();
        self.vertex.clear();
        self.transmitted.clear();
        let constant = |v: Vector<f64>| Vector::new(CornerDual::from_re(v.x), CornerDual::from_re(v.y));
        let multiples = VertexForces {
            area: CornerDual::from_re(held.area),
            perimeter: CornerDual::from_re(held.perimeter),
            turned_perimeter: CornerDual::from_re(held.turned_perimeter),
        };
        for m in 0..sides {
            let next = if m + 1 == sides { 0 } else { m + 1 };
            let plain = self.polygon.corners()[m];
            let seed = |v: Vector<f64>, first: usize| {
                Vector::new(
                    CornerDual::from_re(v.x).derivative(first),
                    CornerDual::from_re(v.y).derivative(first + 1),
                )
            };
            let corner = Corner::new(seed(plain.a, 0), seed(plain.b, 2));
            let perimeter_gradient = side_direction(corner.a) - side_direction(corner.b);
            let force = multiples.on_vertex(constant(self.polygon.area_gradient(m)), perimeter_gradient);
            let on = corner.transmit(force);
            for (force, at) in on.iter().zip([m, next]) {
                for (seeded, b) in [(0, m), (2, next)] {
                    add(&mut blocks[at * sides + b], &block_of(force, seeded));
                }
            }
            self.vertex.push([block_of(&corner.centre, 0), block_of(&corner.centre, 2)]);
            let ([xa, xb], [ya, yb]) =
                (plain.transmit(Vector::new(1.0, 0.0)), plain.transmit(Vector::new(0.0, 1.0)));
            self.transmitted.push([[xa.x, ya.x, xa.y, ya.y], [xb.x, yb.x, xb.y, yb.y]]);
        }
    }

    /// The dependence of each corner on the vertices beside it, through `∂A/∂c_m = ½ ẑ × (c_{m−1} − c_{m+1})`.
    fn fill_neighbouring_vertices(&self, pressure: f64, blocks: &mut [Block]) {
        let sides = self.polygon.len();
        let step = |m: usize, by: usize| if m + by >= sides { m + by - sides } else { m + by };
        for m in 0..sides {
            let next = step(m, 1);
            let (before, after) = (step(m, sides - 1), next);
            for (transmitted, at) in self.transmitted[m].iter().zip([m, next]) {
                for (vertex, weight) in [(before, 0.5 * pressure), (after, -0.5 * pressure)] {
                    let turned = turned_columns(transmitted, weight);
                    for (moved, b) in self.vertex[vertex].iter().zip([vertex, step(vertex, 1)]) {
                        add(&mut blocks[at * sides + b], &product(&turned, moved));
                    }
                }
            }
        }
    }
}

fn block_of(v: &Vector<CornerDual>, first: usize) -> Block {
    [
        derivative(&v.x, first),
        derivative(&v.x, first + 1),
        derivative(&v.y, first),
        derivative(&v.y, first + 1),
    ]
}

/// `weight · m · (ẑ ×)`
fn turned_columns(m: &Block, weight: f64) -> Block {
    let [x, y] = [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)].map(quarter_turn);
    product(m, &[x.x, y.x, x.y, y.y]).map(|entry| weight * entry)
}

pub(crate) fn product(a: &Block, b: &Block) -> Block {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    ]
}

fn add(to: &mut Block, block: &Block) {
    for (total, entry) in to.iter_mut().zip(block) {
        *total += entry;
    }
}
