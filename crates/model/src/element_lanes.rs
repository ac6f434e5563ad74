//! Elements of several cells at once.
//!
//! Cells with one number of sides go through the same operations, so they share them, a lane each. Forces are those of one
//! cell after another, to the last bit.

use crate::assembly::elements_of;
use crate::{Model, VertexForces, WeightedTerm};
use pulp::{Arch, Simd, WithSimd};
use std::any::TypeId;
use std::ops::Range;
use voronudge_geometry::{Arithmetic, Batch, BySides, CellPolygon, Lanes, Scalar, Tessellation, Vector};

/// Whether models can be evaluated in lanes: on plain numbers, with the same functions of area and perimeter for all cells.
pub(crate) fn fit_lanes<S: Scalar>(models: &[Model<S>]) -> bool {
    TypeId::of::<S>() == TypeId::of::<f64>()
        && models.iter().all(|model| !model.has_ring_terms() && !model.environment.cells_differ())
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
    let in_lanes = |w: &WeightedTerm<S>| WeightedTerm {
        term: w.term,
        coefficient: Lanes::constant(w.coefficient.real()),
    };
    let terms = models.iter().map(|model| model.terms.iter().map(in_lanes).collect()).collect();
    let by_sides = BySides::new(tessellation, cells.clone());
    let mut chunk = Chunk { tessellation, positions, terms, cells, forces, on_cells };
    Arch::new().dispatch(Closed { chunk: &mut chunk, by_sides: &by_sides });
    let mut polygon = CellPolygon::default();
    for cell in by_sides.others() {
        let (on_cell, forces) = chunk.of(cell);
        elements_of(cell, tessellation, positions, models, &mut polygon, forces, on_cell);
    }
}

struct Chunk<'a, S> {
    tessellation: &'a Tessellation,
    positions: &'a [Vector<S>],
    terms: Vec<Vec<WeightedTerm<Lanes>>>,
    cells: Range<usize>,
    forces: &'a mut [Vector<S>],
    on_cells: &'a mut [Vector<S>],
}

/// The work on all cells that have a batch.
struct Closed<'a, 'b, S> {
    chunk: &'a mut Chunk<'b, S>,
    by_sides: &'a BySides<'a>,
}

impl<S: Scalar> WithSimd for Closed<'_, '_, S> {
    type Output = ();

    // What is called from here has to be compiled into it, to be compiled for the processor.
    #[inline(always)]
    fn with_simd<A: Simd>(self, _: A) {
        let mut polygon = CellPolygon::<Lanes>::default();
        let zero = Vector::new(Lanes::constant(0.0), Lanes::constant(0.0));
        let mut on_ring = [zero; BySides::MOST_SIDES];
        for sides in 3..=BySides::MOST_SIDES {
            for batch in self.by_sides.batches(sides) {
                batch.fill_ring(self.chunk.positions, polygon.ring_of(sides));
                polygon.complete();
                self.chunk.act(batch, &polygon, &mut on_ring[..sides]);
            }
        }
    }
}

impl<S: Scalar> Chunk<'_, S> {
    /// Where the forces on a cell and on its ring stand, those of one model after another.
    #[inline(always)]
    fn of(&mut self, cell: usize) -> (&mut [Vector<S>], &mut [Vector<S>]) {
        let (models, first) = (self.terms.len(), self.cells.start);
        let ring = self.tessellation.ring(cell);
        let start = self.tessellation.half_edge_start(first);
        (
            &mut self.on_cells[(cell - first) * models..][..models],
            &mut self.forces[(ring.start - start) * models..][..ring.len() * models],
        )
    }

    #[inline(always)]
    fn act(&mut self, batch: Batch<'_>, polygon: &CellPolygon<Lanes>, on_ring: &mut [Vector<Lanes>]) {
        let sides = on_ring.len();
        for model in 0..self.terms.len() {
            let on_cells = VertexForces::of(&self.terms[model], polygon.shape()).on_ring(polygon, on_ring);
            for (lane, cell) in batch.cells().enumerate() {
                let plain =
                    |v: &Vector<Lanes>| Vector::new(S::constant(v.x.0[lane]), S::constant(v.y.0[lane]));
                let (on_cell, forces) = self.of(cell);
                on_cell[model] = plain(&on_cells);
                for (force, lanes) in forces[model * sides..][..sides].iter_mut().zip(&*on_ring) {
                    *force = plain(lanes);
                }
            }
        }
    }
}
