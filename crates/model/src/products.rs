//! Products with the Jacobian, without the matrix.

use crate::assembly::VelocityAssembly;
use crate::element_jacobian::{ByShape, held, seeded, turn};
use crate::has_velocity::has_velocity;
use crate::{Model, VertexForces, WeightedTerm, jacobian};
use num_dual::Dual64;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;
use voronudge_geometry::{
    Arithmetic, BySides, CellPolygon, Lanes, Outer, Tangent, Tessellation, Vector, dot, quarter_turn,
};

/// `J u`: how velocities change (N) when all cells are displaced along `u` (N), exact to rounding for every model. Zero for cells without a velocity.
pub fn jvp(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    model: &Model<f64>,
    u: &[Vector<f64>],
) -> Vec<Vector<f64>> {
    let moved: Vec<Vector<Dual64>> = (positions.iter().zip(u))
        .map(|(r, u)| Vector::new(Dual64::new(r.x, u.x), Dual64::new(r.y, u.y)))
        .collect();
    let mut v = Vec::new();
    VelocityAssembly::default().evaluate(tessellation, &moved, &model.lift(), &mut v);
    let change = |(cell, v): (usize, Vector<Dual64>)| match has_velocity(tessellation, cell) {
        true => Vector::new(v.x.eps, v.y.eps),
        false => Vector::zeros(),
    };
    v.into_iter().enumerate().map(change).collect()
}

/// `Jᵀ w`: the derivative of `Σ_i w_i·v_i` by each position (N). What `w` (N) has for cells without a velocity does not matter.
///
/// Functions of areas and perimeters are differentiated backwards, element by element, for about twice the price of the forces; models with
/// other terms, responses or differing cells by [`jacobian`], and as exactly as that.
///
/// With `u` the difference of `w` from that of the cell, an element has `Σ_a g_a·u_a = Σ_m f_m·δc_m`: forces on vertices times how
/// these move if the ring is displaced along `u`. Its derivative by the ring is
///
/// ```text
/// by q:                λ_s = Σ_q ∂q/∂s Σ_m ∂(f_m·δc_m)/∂q       the force λ_A ∂A/∂c_m + λ_P ∂P/∂c_m on vertex m
/// by other vertices:   the force ½ q_A ẑ × (δc_{m−1} − δc_{m+1}) on vertex m
/// by the corner:       its slopes at held multiples and vertices, transposed
/// ```
pub fn vjp(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    model: &Model<f64>,
    w: &[Vector<f64>],
) -> Vec<Vector<f64>> {
    if model.has_ring_terms() || !model.responses.is_empty() || !model.cells_are_alike() {
        return jacobian(tessellation, positions, model).apply_transposed(w);
    }
    let counts = |(cell, w): (usize, &Vector<f64>)| {
        if has_velocity(tessellation, cell) { *w } else { Vector::zeros() }
    };
    let w: Vec<Vector<f64>> = w.iter().enumerate().map(counts).collect();
    let mut sums = Vec::new();
    VelocityAssembly::default().assemble(tessellation, &mut sums, |cells, on_rings, on_cells| {
        let mut chunk = Chunk { tessellation, positions, w: &w, cells, on_rings, on_cells };
        chunk.differentiate(model);
    });
    sums
}

struct Chunk<'a> {
    tessellation: &'a Tessellation,
    positions: &'a [Vector<f64>],
    w: &'a [Vector<f64>],
    cells: Range<usize>,
    on_rings: &'a mut [Vector<f64>],
    on_cells: &'a mut [Vector<f64>],
}

impl Chunk<'_> {
    fn differentiate(&mut self, model: &Model<f64>) {
        let in_lanes = |w: &WeightedTerm<f64>| WeightedTerm {
            term: w.term,
            coefficient: ByShape::<Lanes>::constant(w.coefficient),
        };
        let terms: Vec<_> = model.terms.iter().map(in_lanes).collect();
        let by_sides = BySides::new(self.tessellation, self.cells.clone());
        Arch::new().dispatch(Closed { chunk: self, by_sides: &by_sides, terms: &terms });
        let model = model.map(Tangent::held);
        let (mut polygon, mut element) = (CellPolygon::default(), Backwards::default());
        for cell in by_sides.others() {
            if self.tessellation.is_closed(cell) {
                polygon.fill(self.tessellation, self.positions, cell);
                element.reserve(polygon.len());
                for (u, &other) in element.u.iter_mut().zip(self.tessellation.neighbours(cell)) {
                    *u = self.w[other as usize] - self.w[cell];
                }
                let multiples = VertexForces::of(&model.terms, seeded(polygon.shape()));
                let on_cell = element.differentiate(&polygon, &multiples);
                self.write(cell, on_cell, |m| element.on_ring[m]);
            } else {
                self.write(cell, Vector::zeros(), |_| Vector::zeros());
            }
        }
    }

    #[inline(always)]
    fn write(&mut self, cell: usize, on_cell: Vector<f64>, on_ring: impl Fn(usize) -> Vector<f64>) {
        self.on_cells[cell - self.cells.start] = on_cell;
        let ring = self.tessellation.ring(cell);
        let start = ring.start - self.tessellation.half_edge_start(self.cells.start);
        for (m, to) in self.on_rings[start..start + ring.len()].iter_mut().enumerate() {
            *to = on_ring(m);
        }
    }
}

/// The work on all cells that have a batch.
struct Closed<'a, 'b> {
    chunk: &'a mut Chunk<'b>,
    by_sides: &'a BySides<'a>,
    terms: &'a [WeightedTerm<ByShape<Lanes>>],
}

impl WithSimd for Closed<'_, '_> {
    type Output = ();

    // What is called from here has to be compiled into it, to be compiled for the processor.
    #[inline(always)]
    fn with_simd<A: Simd>(self, _: A) {
        let (mut polygon, mut element) = (CellPolygon::<Lanes>::default(), Backwards::<Lanes>::default());
        for sides in 3..=BySides::MOST_SIDES {
            for batch in self.by_sides.batches(sides) {
                batch.fill_ring(self.chunk.positions, polygon.ring_of(sides), Lanes::put);
                polygon.complete();
                element.reserve(sides);
                batch.each(|lane, cell| {
                    let own = self.chunk.w[cell];
                    let others = self.chunk.tessellation.neighbours(cell);
                    for (u, &other) in element.u.iter_mut().zip(others) {
                        let other = self.chunk.w[other as usize];
                        u.x.put(lane, other.x - own.x);
                        u.y.put(lane, other.y - own.y);
                    }
                });
                let on_cells =
                    element.differentiate(&polygon, &VertexForces::of(self.terms, seeded(polygon.shape())));
                batch.each(|lane, cell| {
                    let one = |v: &Vector<Lanes>| Vector::new(v.x.0[lane], v.y.0[lane]);
                    self.chunk.write(cell, one(&on_cells), |m| one(&element.on_ring[m]));
                });
            }
        }
    }
}

/// Buffers for elements differentiated one after another.
struct Backwards<S> {
    /// Differences of `w` from that of the cell.
    u: Vec<Vector<S>>,
    /// How the vertices move along `u`.
    moved: Vec<Vector<S>>,
    /// How the unit vectors along the sides change with the neighbours.
    turns: Vec<Outer<S>>,
    /// The derivative by each of the ring.
    on_ring: Vec<Vector<S>>,
}

impl<S: Arithmetic> Default for Backwards<S> {
    fn default() -> Self {
        Self { u: Vec::new(), moved: Vec::new(), turns: Vec::new(), on_ring: Vec::new() }
    }
}

impl<S: Arithmetic> Backwards<S> {
    #[inline(always)]
    fn reserve(&mut self, sides: usize) {
        if self.u.len() != sides {
            let zero = Vector::new(S::constant(0.0), S::constant(0.0));
            for array in [&mut self.u, &mut self.moved, &mut self.on_ring] {
                array.resize(sides, zero);
            }
            self.turns.resize(sides, Outer { column: zero, row: zero });
        }
    }

    /// Writes the derivatives by the ring and returns that by the cell.
    #[inline(always)]
    fn differentiate(&mut self, polygon: &CellPolygon<S>, multiples: &VertexForces<ByShape<S>>) -> Vector<S> {
        let sides = polygon.len();
        let corners = &polygon.corners()[..sides];
        let (u, moved) = (&self.u[..sides], &mut self.moved[..sides]);
        let (turns, on_ring) = (&mut self.turns[..sides], &mut self.on_ring[..sides]);
        let held = held(multiples);
        let next = |m: usize| if m + 1 == sides { 0 } else { m + 1 };
        let zero = S::constant(0.0);
        let (mut of_area, mut of_perimeter, mut turned) = (zero, zero, zero);
        for m in 0..sides {
            let [by_a, by_b] = corners[m].centre_slopes();
            moved[m] = by_a.column * dot(by_a.row, u[m]) + by_b.column * dot(by_b.row, u[next(m)]);
            let by_perimeter = polygon.perimeter_gradient(m);
            of_area += dot(polygon.area_gradient(m), moved[m]);
            of_perimeter += dot(by_perimeter, moved[m]);
            turned += dot(quarter_turn(by_perimeter), moved[m]);
            turns[m] = turn(polygon, m, &held);
            on_ring[m] = Vector::new(zero, zero);
        }
        let [by_area, by_perimeter] = [0, 1].map(|by| {
            of_area * multiples.area.slopes[by]
                + of_perimeter * multiples.perimeter.slopes[by]
                + turned * multiples.chiral_tension.slopes[by]
        });
        let mut on_cell = Vector::new(zero, zero);
        for m in 0..sides {
            let (before, after) = (if m == 0 { sides - 1 } else { m - 1 }, next(m));
            let (area_gradient, perimeter_gradient) =
                (polygon.area_gradient(m), polygon.perimeter_gradient(m));
            let beside = quarter_turn(moved[before] - moved[after]) * (held.area * 0.5);
            let on_vertex = area_gradient * by_area + perimeter_gradient * by_perimeter + beside;
            let [mut on_this, mut on_next] = corners[m].pull_back(on_vertex);
            let by_next = Outer { column: -turns[after].column, row: turns[after].row };
            let force = held.on_vertex(area_gradient, perimeter_gradient);
            let slopes = [turns[m], by_next];
            let [more_on_this, more_on_next] =
                corners[m].pull_back_slopes_transposed(force, slopes, [u[m], u[after]]);
            on_this += more_on_this;
            on_next += more_on_next;
            on_ring[m] += on_this;
            on_ring[after] += on_next;
            on_cell -= on_this + on_next;
        }
        on_cell
    }
}
