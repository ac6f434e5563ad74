//! Elements of several cells at once.
//!
//! Cells with one number of sides go through the same operations, so they share them, a lane each. Forces are those of one
//! cell after another, to the last bit; derivatives to rounding.

use crate::element::elements_of;
use crate::{Model, VertexForces, WeightedTerm};
use num_dual::Dual64;
use pulp::{Arch, Simd, WithSimd};
use std::any::{Any, TypeId};
use std::ops::Range;
use voronudge_geometry::{
    Arithmetic, Batch, BySides, CellPolygon, Lanes, Scalar, Tangent, Tessellation, Vector,
};

/// Numbers of several cells, for the scalar that each is one of.
trait InLanes<S>: Arithmetic {
    fn lift(value: S) -> Self;
    fn put(&mut self, lane: usize, value: S);
    fn take(&self, lane: usize) -> S;
}

impl<S: Scalar> InLanes<S> for Lanes {
    #[inline(always)]
    fn lift(value: S) -> Self {
        Self::constant(value.real())
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, value: S) {
        self.0[lane] = value.real();
    }

    #[inline(always)]
    fn take(&self, lane: usize) -> S {
        S::constant(self.0[lane])
    }
}

/// For dual numbers with one derivative.
impl<S: Scalar> InLanes<S> for Tangent<Lanes, 1> {
    #[inline(always)]
    fn lift(value: S) -> Self {
        Self { value: Lanes::constant(value.real()), slopes: [Lanes::constant(slope(&value))] }
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, value: S) {
        self.value.0[lane] = value.real();
        self.slopes[0].0[lane] = slope(&value);
    }

    #[inline(always)]
    fn take(&self, lane: usize) -> S {
        let dual = Dual64::new(self.value.0[lane], self.slopes[0].0[lane]);
        (&dual as &dyn Any).downcast_ref::<S>().copied().unwrap_or(S::constant(dual.re))
    }
}

#[inline(always)]
fn slope<S: Scalar>(value: &S) -> f64 {
    (value as &dyn Any).downcast_ref::<Dual64>().map_or(0.0, |dual| dual.eps)
}

/// Models that can be evaluated in lanes: on plain numbers or dual numbers with one derivative, with the same functions of area and perimeter for all cells.
pub(crate) fn fit_lanes<S: Scalar>(models: &[Model<S>]) -> bool {
    [TypeId::of::<f64>(), TypeId::of::<Dual64>()].contains(&TypeId::of::<S>())
        && models.iter().all(|model| !model.has_ring_terms() && model.cells_are_alike())
}

/// The elements of a chunk of cells under models that [`fit_lanes`].
pub(crate) fn elements_in_lanes<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    models: &[Model<S>],
    cells: Range<usize>,
    forces: &mut [Vector<S>],
    on_cells: &mut [Vector<S>],
) {
    let by_sides = BySides::new(tessellation, cells.clone());
    let mut chunk = Chunk { tessellation, positions, models, cells, forces, on_cells };
    // Sizes are known when this is compiled, and nothing else is then compiled for a scalar; identities are not.
    if const { size_of::<S>() == size_of::<f64>() } {
        chunk.closed::<Lanes>(&by_sides);
    } else if const { size_of::<S>() == size_of::<Dual64>() } {
        chunk.closed::<Tangent<Lanes, 1>>(&by_sides);
    }
    let mut polygon = CellPolygon::default();
    for cell in by_sides.others() {
        let (on_cell, forces) = chunk.of(cell);
        elements_of(cell, tessellation, positions, models, &mut polygon, forces, on_cell);
    }
}

struct Chunk<'a, S> {
    tessellation: &'a Tessellation,
    positions: &'a [Vector<S>],
    models: &'a [Model<S>],
    cells: Range<usize>,
    forces: &'a mut [Vector<S>],
    on_cells: &'a mut [Vector<S>],
}

impl<S: Scalar> Chunk<'_, S> {
    /// All cells that have a batch.
    fn closed<L: InLanes<S>>(&mut self, by_sides: &BySides<'_>) {
        let lift = |w: &WeightedTerm<S>| WeightedTerm { term: w.term, coefficient: L::lift(w.coefficient) };
        let terms: Vec<Vec<_>> =
            self.models.iter().map(|model| model.terms.iter().map(lift).collect()).collect();
        Arch::new().dispatch(Closed { chunk: self, by_sides, terms: &terms });
    }

    /// Where the forces on a cell and on its ring stand, those of one model after another.
    #[inline(always)]
    fn of(&mut self, cell: usize) -> (&mut [Vector<S>], &mut [Vector<S>]) {
        let (models, first) = (self.models.len(), self.cells.start);
        let ring = self.tessellation.ring(cell);
        let start = self.tessellation.half_edge_start(first);
        (
            &mut self.on_cells[(cell - first) * models..][..models],
            &mut self.forces[(ring.start - start) * models..][..ring.len() * models],
        )
    }

    #[inline(always)]
    fn act<L: InLanes<S>>(
        &mut self,
        batch: Batch<'_>,
        terms: &[Vec<WeightedTerm<L>>],
        polygon: &CellPolygon<L>,
        on_ring: &mut [Vector<L>],
    ) {
        let sides = on_ring.len();
        for (model, terms) in terms.iter().enumerate() {
            let on_cells = VertexForces::of(terms, polygon.shape()).on_ring(polygon, on_ring);
            batch.each(|lane, cell| {
                let one = |v: &Vector<L>| Vector::new(v.x.take(lane), v.y.take(lane));
                let (on_cell, forces) = self.of(cell);
                on_cell[model] = one(&on_cells);
                for (force, lanes) in forces[model * sides..][..sides].iter_mut().zip(&*on_ring) {
                    *force = one(lanes);
                }
            });
        }
    }
}

/// The work on all cells that have a batch.
struct Closed<'a, 'b, S, L> {
    chunk: &'a mut Chunk<'b, S>,
    by_sides: &'a BySides<'a>,
    terms: &'a [Vec<WeightedTerm<L>>],
}

impl<S: Scalar, L: InLanes<S>> WithSimd for Closed<'_, '_, S, L> {
    type Output = ();

    // What is called from here has to be compiled into it, to be compiled for the processor.
    #[inline(always)]
    fn with_simd<A: Simd>(self, _: A) {
        let mut polygon = CellPolygon::<L>::default();
        let zero = Vector::new(L::constant(0.0), L::constant(0.0));
        let mut on_ring = [zero; BySides::MOST_SIDES];
        for sides in 3..=BySides::MOST_SIDES {
            for batch in self.by_sides.batches(sides) {
                batch.fill_ring(self.chunk.positions, polygon.ring_of(sides), L::put);
                polygon.complete();
                self.chunk.act(batch, self.terms, &polygon, &mut on_ring[..sides]);
            }
        }
    }
}
