//! The derivatives of elements, by the positions of the cell and of its ring.

use crate::block_matrix::Block;
use crate::element_jacobian::{BlockOf, ByShape, ElementJacobian, along, seeded};
use crate::ring_jacobian::RingJacobian;
use crate::{Model, VertexForces, WeightedTerm};
use pulp::{Arch, Simd, WithSimd};
use voronudge_geometry::{Arithmetic, BySides, CellPolygon, Lanes, Shape, Tangent, Tessellation, Vector};

/// The derivatives of the elements that act on some cells: their own, and those of their neighbours.
///
/// Of each closed cell of n sides (n + 1)² blocks: the derivative of the force on the cell, then on each of its ring, by the position
/// of the cell, then of each of its ring.
pub(crate) struct ElementBlocks<'a> {
    work: Elements<'a>,
    /// The cells, and where the blocks of each begin.
    cells: Vec<u32>,
    start: Vec<u32>,
    /// Of every cell of the tissue, its number among the cells at hand; else any number.
    number: Vec<u32>,
    blocks: Vec<Block>,
}

impl<'a> ElementBlocks<'a> {
    pub fn new(tessellation: &'a Tessellation, positions: &'a [Vector<f64>], model: &Model<f64>) -> Self {
        let number = vec![u32::MAX; tessellation.len()];
        let work = Elements::new(tessellation, positions, model);
        Self { work, cells: Vec::new(), start: Vec::new(), number, blocks: Vec::new() }
    }

    /// Differentiates the elements that act on some cells.
    pub fn evaluate(&mut self, own: &[u32]) {
        let tessellation = self.work.tessellation;
        self.cells.clear();
        self.start.clear();
        let mut total = 0;
        let mut enter = |cell: u32| {
            let entered = self.cells.get(self.number[cell as usize] as usize);
            if entered != Some(&cell) {
                self.number[cell as usize] = self.cells.len() as u32;
                self.cells.push(cell);
                self.start.push(total);
                total += (tessellation.neighbours(cell as usize).len() as u32 + 1).pow(2);
            }
        };
        own.iter().for_each(|&cell| enter(cell));
        own.iter().flat_map(|&cell| tessellation.neighbours(cell as usize)).for_each(|&cell| enter(cell));
        self.blocks.resize(total as usize, [0.0; 4]);
        let Self { work, cells, start, number, blocks } = self;
        for cells in cells.chunks(BySides::MOST_CELLS) {
            work.fill(cells, |cell| start[number[cell] as usize] as usize, blocks);
        }
    }

    /// The blocks of the force on the cell itself (0) or on a member of its ring (from 1).
    #[inline]
    pub fn row(&self, cell: usize, sides: usize, of: usize) -> &[Block] {
        &self.blocks[self.start[self.number[cell] as usize] as usize + of * (sides + 1)..][..sides + 1]
    }
}

/// Work on elements.
struct Elements<'a> {
    tessellation: &'a Tessellation,
    positions: &'a [Vector<f64>],
    /// With the terms as functions of area and perimeter.
    model: Model<ByShape<f64>>,
    /// The same terms for several cells, if all have them.
    in_lanes: Option<Vec<WeightedTerm<ByShape<Lanes>>>>,
    polygon: CellPolygon<f64>,
    one: Work<f64>,
    on_ring: Vec<Vector<f64>>,
    several: Work<Lanes>,
    ring_terms: Option<RingJacobian>,
}

impl<'a> Elements<'a> {
    fn new(tessellation: &'a Tessellation, positions: &'a [Vector<f64>], model: &Model<f64>) -> Self {
        let in_lanes = |w: &WeightedTerm<f64>| WeightedTerm {
            term: w.term,
            coefficient: Tangent::constant(w.coefficient),
        };
        Self {
            tessellation,
            positions,
            model: model.map(Tangent::held),
            in_lanes: model.cells_are_alike().then(|| model.terms.iter().map(in_lanes).collect()),
            polygon: CellPolygon::default(),
            one: Work::default(),
            on_ring: Vec::new(),
            several: Work::default(),
            ring_terms: model.has_ring_terms().then(|| RingJacobian::new(model)),
        }
    }

    fn fill(&mut self, cells: &[u32], start: impl Fn(usize) -> usize, blocks: &mut [Block]) {
        let tessellation = self.tessellation;
        let of = |cell: usize| start(cell)..start(cell) + (tessellation.ring(cell).len() + 1).pow(2);
        let closed = || cells.iter().map(|&cell| cell as usize).filter(|&cell| tessellation.is_closed(cell));
        if let Some(terms) = &self.in_lanes {
            let by_sides = BySides::new(tessellation, closed());
            Arch::new().dispatch(Several {
                by_sides: &by_sides,
                positions: self.positions,
                terms,
                work: &mut self.several,
                start: &start,
                blocks,
            });
            by_sides.others().for_each(|cell| self.fill_one(cell, &mut blocks[of(cell)]));
        } else {
            closed().for_each(|cell| self.fill_one(cell, &mut blocks[of(cell)]));
        }
        if let Some(ring_terms) = &mut self.ring_terms {
            closed().for_each(|cell| {
                ring_terms.add(tessellation, self.positions, cell, &mut blocks[of(cell)]);
            });
        }
    }

    fn fill_one(&mut self, cell: usize, blocks: &mut [Block]) {
        let Self { tessellation, positions, model, polygon, one, .. } = self;
        polygon.fill(tessellation, positions, cell);
        let (points, r, shape) = (polygon.len() + 1, positions[cell], polygon.shape());
        let site = |position| model.site(cell, polygon.len(), position);
        let multiples = VertexForces::of_cell(model, site(Tangent::held_vector(r)), seeded(shape));
        blocks.copy_from_slice(one.fill(polygon, &multiples));
        if !model.has_modulated_terms() {
            return;
        }
        // Coefficients change with the place of the cell.
        let shape = Shape { area: Tangent::held(shape.area), perimeter: Tangent::held(shape.perimeter) };
        let multiples = VertexForces::of_cell(model, site(Tangent::seeded_vector(r)), shape);
        self.on_ring.resize(polygon.len(), Vector::zeros());
        for direction in 0..2 {
            let on_cell = along(&multiples, direction).on_ring(polygon, &mut self.on_ring);
            for (row, force) in blocks.chunks_exact_mut(points).zip([on_cell].iter().chain(&self.on_ring)) {
                row[0][direction] += force.x;
                row[0][2 + direction] += force.y;
            }
        }
    }
}

/// The blocks of an element by its ring, and by its ring and the cell.
struct Work<S> {
    jacobian: ElementJacobian<S>,
    by_ring: Vec<BlockOf<S>>,
    all: Vec<BlockOf<S>>,
}

impl<S: Arithmetic> Default for Work<S> {
    fn default() -> Self {
        Self { jacobian: ElementJacobian::default(), by_ring: Vec::new(), all: Vec::new() }
    }
}

impl<S: Arithmetic> Work<S> {
    /// The forces on the ring change with its displacements from the cell; that on the cell is minus their sum.
    #[inline(always)]
    fn fill(&mut self, polygon: &CellPolygon<S>, multiples: &VertexForces<ByShape<S>>) -> &[BlockOf<S>] {
        let (sides, zero) = (polygon.len(), S::constant(0.0));
        let points = sides + 1;
        if self.by_ring.len() != sides * sides {
            self.by_ring.resize(sides * sides, [zero; 4]);
            self.all.resize(points * points, [zero; 4]);
        }
        self.jacobian.fill(polygon, multiples, &mut self.by_ring);
        let (own, ring) = self.all[..points * points].split_at_mut(points);
        for block in own.iter_mut() {
            *block = [zero; 4];
        }
        for a in 0..sides {
            let (from, to) = (&self.by_ring[a * sides..][..sides], &mut ring[a * points..][..points]);
            let mut sum = [zero; 4];
            for b in 0..sides {
                to[b + 1] = from[b];
                for k in 0..4 {
                    sum[k] -= from[b][k];
                    own[b + 1][k] -= from[b][k];
                }
            }
            to[0] = sum;
            for k in 0..4 {
                own[0][k] -= sum[k];
            }
        }
        &self.all[..points * points]
    }
}

/// The work on all cells that have a batch.
struct Several<'a, F> {
    by_sides: &'a BySides<'a>,
    positions: &'a [Vector<f64>],
    terms: &'a [WeightedTerm<ByShape<Lanes>>],
    work: &'a mut Work<Lanes>,
    start: &'a F,
    blocks: &'a mut [Block],
}

impl<F: Fn(usize) -> usize> WithSimd for Several<'_, F> {
    type Output = ();

    // What is called from here has to be compiled into it, to be compiled for the processor.
    #[inline(always)]
    fn with_simd<A: Simd>(self, _: A) {
        let mut polygon = CellPolygon::<Lanes>::default();
        for sides in 3..=BySides::MOST_SIDES {
            for batch in self.by_sides.batches(sides) {
                batch.fill_ring(self.positions, polygon.ring_of(sides), Lanes::put);
                polygon.complete();
                let multiples = VertexForces::of(self.terms, seeded(polygon.shape()));
                let all = self.work.fill(&polygon, &multiples);
                batch.each(|lane, cell| {
                    let blocks = &mut self.blocks[(self.start)(cell)..][..all.len()];
                    for (block, lanes) in blocks.iter_mut().zip(all) {
                        *block = std::array::from_fn(|entry| lanes[entry].0[lane]);
                    }
                });
            }
        }
    }
}
