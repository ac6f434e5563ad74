//! The exact derivative of one cell's element with respect to the positions of its ring.
//!
//! With the multiples `q = (q_A, q_P, q_T)` of the vertex forces held, what a corner pulls back depends on its own two
//! neighbours and, through the area's gradient, linearly on the two vertices beside it. The multiples depend on the ring
//! through the cell's area and perimeter alone. So
//!
//! ```text
//! ∂g/∂d = ∂g/∂d |_q  +  Σ_{s ∈ {A, P}} ( ∂g/∂q · ∂q/∂s ) ⊗ ∂s/∂d
//! ```
//!
//! needs dual numbers along two directions for the terms, whatever the number of sides; the derivatives of the geometry at a corner are
//! [`Corner::pull_back_slopes`]. All of it is generic, so it works on several cells at once.

use crate::VertexForces;
use voronudge_geometry::{
    Arithmetic, CellPolygon, Outer, Shape, Tangent, Vector, quarter_turn, side_direction_slope,
};

/// A block `[xx, xy, yx, yy]`, row = component of the force.
pub(crate) type BlockOf<S> = [S; 4];

/// By area and perimeter.
pub(crate) type ByShape<S> = Tangent<S, 2>;

/// Area and perimeter, as what is differentiated by.
#[inline(always)]
pub(crate) fn seeded<S: Arithmetic>(shape: Shape<S>) -> Shape<ByShape<S>> {
    Shape { area: Tangent::along(shape.area, 0), perimeter: Tangent::along(shape.perimeter, 1) }
}

/// Multiples as they are at the shape by which they are differentiated.
#[inline(always)]
pub(crate) fn held<S: Arithmetic>(multiples: &VertexForces<ByShape<S>>) -> VertexForces<S> {
    VertexForces {
        area: multiples.area.value,
        perimeter: multiples.perimeter.value,
        chiral_tension: multiples.chiral_tension.value,
    }
}

/// The derivatives of multiples along a direction.
#[inline(always)]
pub(crate) fn along<S: Arithmetic>(
    multiples: &VertexForces<ByShape<S>>,
    direction: usize,
) -> VertexForces<S> {
    VertexForces {
        area: multiples.area.slopes[direction],
        perimeter: multiples.perimeter.slopes[direction],
        chiral_tension: multiples.chiral_tension.slopes[direction],
    }
}

/// How the force on the vertex at the beginning of side `m` (and, reversed, on that at its end) changes with neighbour `m` by the direction of the side.
#[inline(always)]
pub(crate) fn turn<S: Arithmetic>(polygon: &CellPolygon<S>, m: usize, held: &VertexForces<S>) -> Outer<S> {
    let Outer { column, row } = side_direction_slope(polygon.ring()[m], polygon.directions()[m]);
    Outer { column: column * held.perimeter + quarter_turn(column) * held.chiral_tension, row }
}

/// Buffers for the derivative of one element after another.
pub(crate) struct ElementJacobian<S> {
    /// How the unit vectors along the sides change with the neighbours that these face.
    turns: Vec<Outer<S>>,
    /// ∂c_m/∂d_m and ∂c_m/∂d_{m+1}
    vertices: Vec<[Outer<S>; 2]>,
    /// The forces on the ring for one as the multiple of the area's gradient, of the perimeter's, and of the turned one.
    units: [Vec<Vector<S>>; 3],
}

impl<S: Arithmetic> Default for ElementJacobian<S> {
    fn default() -> Self {
        let units = [Vec::new(), Vec::new(), Vec::new()];
        Self { turns: Vec::new(), vertices: Vec::new(), units }
    }
}

impl<S: Arithmetic> ElementJacobian<S> {
    /// Fills `∂g_a/∂d_b`, row-major in (a, b), for the ring of a polygon and the multiples of its vertex forces.
    #[inline(always)]
    pub(crate) fn fill(
        &mut self,
        polygon: &CellPolygon<S>,
        multiples: &VertexForces<ByShape<S>>,
        blocks: &mut [BlockOf<S>],
    ) {
        self.reserve(polygon.len());
        self.fill_by_shape(polygon, multiples, blocks);
        self.fill_corners(polygon, multiples, blocks);
        self.fill_neighbouring_vertices(polygon, multiples.area.value, blocks);
    }

    #[inline(always)]
    fn reserve(&mut self, sides: usize) {
        if self.vertices.len() == sides {
            return;
        }
        let zero = S::constant(0.0);
        let nowhere = Vector::new(zero, zero);
        let still = Outer { column: nowhere, row: nowhere };
        self.turns.resize(sides, still);
        self.vertices.resize(sides, [still; 2]);
        self.units.iter_mut().for_each(|unit| unit.resize(sides, nowhere));
    }

    #[inline(always)]
    fn fill_by_shape(
        &mut self,
        polygon: &CellPolygon<S>,
        multiples: &VertexForces<ByShape<S>>,
        blocks: &mut [BlockOf<S>],
    ) {
        let sides = polygon.len();
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let [of_area, of_perimeter, turned] = &mut self.units;
        let unit = |area, perimeter, chiral_tension| VertexForces { area, perimeter, chiral_tension };
        unit(one, zero, zero).on_ring(polygon, of_area);
        unit(zero, one, zero).on_ring(polygon, of_perimeter);
        unit(zero, zero, one).on_ring(polygon, turned);
        let (of_area, of_perimeter, turned) = (&of_area[..sides], &of_perimeter[..sides], &turned[..sides]);
        for a in 0..sides {
            let [by_area, by_perimeter] = [0, 1].map(|by| {
                of_area[a] * multiples.area.slopes[by]
                    + of_perimeter[a] * multiples.perimeter.slopes[by]
                    + turned[a] * multiples.chiral_tension.slopes[by]
            });
            let row = &mut blocks[a * sides..][..sides];
            // The unit forces are the gradients of area and perimeter by the ring.
            for b in 0..sides {
                let (area, perimeter) = (of_area[b], of_perimeter[b]);
                row[b] = [
                    by_area.x * area.x + by_perimeter.x * perimeter.x,
                    by_area.x * area.y + by_perimeter.x * perimeter.y,
                    by_area.y * area.x + by_perimeter.y * perimeter.x,
                    by_area.y * area.y + by_perimeter.y * perimeter.y,
                ];
            }
        }
    }

    /// The dependence of each corner on its own two neighbours, with the vertices beside it held.
    #[inline(always)]
    fn fill_corners(
        &mut self,
        polygon: &CellPolygon<S>,
        multiples: &VertexForces<ByShape<S>>,
        blocks: &mut [BlockOf<S>],
    ) {
        let sides = polygon.len();
        let corners = &polygon.corners()[..sides];
        let (turns, vertices) = (&mut self.turns[..sides], &mut self.vertices[..sides]);
        let held = held(multiples);
        for (m, of_side) in turns.iter_mut().enumerate() {
            *of_side = turn(polygon, m, &held);
        }
        for (m, corner) in corners.iter().enumerate() {
            let next = if m + 1 == sides { 0 } else { m + 1 };
            let force = held.on_vertex(polygon.area_gradient(m), polygon.perimeter_gradient(m));
            let by_next = Outer { column: -turns[next].column, row: turns[next].row };
            let [on_this, on_next] = corner.pull_back_slopes(force, [turns[m], by_next]);
            for (on, at) in [(on_this, m), (on_next, next)] {
                add(&mut blocks[at * sides + m], &on[0]);
                add(&mut blocks[at * sides + next], &on[1]);
            }
            vertices[m] = corner.centre_slopes();
        }
    }

    /// The dependence of each corner on the vertices beside it, through `∂A/∂c_m = ½ ẑ × (c_{m−1} − c_{m+1})`.
    #[inline(always)]
    fn fill_neighbouring_vertices(&self, polygon: &CellPolygon<S>, pressure: S, blocks: &mut [BlockOf<S>]) {
        let sides = polygon.len();
        let step = |m: usize, by: usize| if m + by >= sides { m + by - sides } else { m + by };
        let (corners, vertices) = (&polygon.corners()[..sides], &self.vertices[..sides]);
        let half = pressure * 0.5;
        for (m, corner) in corners.iter().enumerate() {
            let next = step(m, 1);
            for (beside, weight) in [(step(m, sides - 1), half), (next, -half)] {
                for (moved, b) in vertices[beside].iter().zip([beside, step(beside, 1)]) {
                    let [on_this, on_next] = corner.pull_back(quarter_turn(moved.column) * weight);
                    for (on, at) in [(on_this, m), (on_next, next)] {
                        let (x, y) = (moved.row.x, moved.row.y);
                        add(&mut blocks[at * sides + b], &[on.x * x, on.x * y, on.y * x, on.y * y]);
                    }
                }
            }
        }
    }
}

#[inline(always)]
pub(crate) fn product<S: Arithmetic>(a: &BlockOf<S>, b: &BlockOf<S>) -> BlockOf<S> {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    ]
}

#[inline(always)]
fn add<S: Arithmetic>(to: &mut BlockOf<S>, block: &BlockOf<S>) {
    for (total, entry) in to.iter_mut().zip(block) {
        *total += *entry;
    }
}
