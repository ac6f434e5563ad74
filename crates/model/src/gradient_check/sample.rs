//! The positions under check: which cells are displaced, how far, and where the topology is ambiguous.

use super::CELL_LIMIT;
use crate::element::ring_terms;
use crate::{CellElement, Environment, Model, RingForces, VectorMap, VertexForces};
use std::sync::Arc;
use voronudge_geometry::{CellPolygon, Domain, Error, FieldOfView, Grid, Shape, Tessellation, Vector, cross};

/// Positions, and what the checks need to know about them.
pub(super) struct Sample {
    pub positions: Vec<Vector<f64>>,
    pub tessellation: Tessellation,
    /// The cells that are displaced.
    pub displaced: Vec<usize>,
    /// Step of central differences for each cell: a small part of the distance to the nearest position where a formula
    /// is singular, which is the line through two cells that share a vertex with it.
    pub step: Vec<f64>,
    /// Cells whose velocity does not depend on how cells on a common circle were triangulated.
    pub unambiguous: Vec<bool>,
    /// Cells that count: in an open field, those away from its rim.
    pub trusted: Vec<bool>,
    /// Closed cells that act on any with a velocity, in an open field.
    acting: Vec<bool>,
    /// √(area per cell)
    pub spacing: f64,
    /// Largest distance of two neighbours on which a velocity depends.
    pub widest: f64,
    /// Largest magnitude of a coordinate, or of one that a lattice vector may add.
    pub reach: f64,
    /// Labels, earlier velocities and, in an open field, an edge and a map, made up for the effects that need them.
    pub environment: Arc<Environment>,
}

/// Step of central differences relative to the distance of a singularity.
const STEP: f64 = 1.0 / 128.0;

/// Smallest useful step relative to √(area per cell): rounding of a displacement then changes it by 1e-6.
const SMALLEST_STEP: f64 = 2e-10;

impl Sample {
    pub fn new(positions: &[Vector<f64>], domain: Domain) -> Result<Self, Error> {
        let tessellation = Tessellation::new(positions, domain)?;
        let cells = positions.len();
        let largest = positions.iter().flat_map(|r| [r.x.abs(), r.y.abs()]).fold(0.0, f64::max);
        let (area, reach) = match domain {
            Domain::Periodic(cell_box) => {
                let [x, y] = cell_box.lengths();
                (cell_box.area(), largest + x.max(y) + cell_box.offset().abs())
            }
            Domain::Open => (extent(positions), 2.0 * largest),
        };
        let spacing = (area / cells as f64).sqrt();
        let acting = acting(&tessellation);
        let view = FieldOfView::default().judge(&tessellation, positions);
        let trusted: Vec<bool> = (0..cells).map(|cell| view.counts(cell)).collect();
        let count = cells.min((CELL_LIMIT * CELL_LIMIT / cells).max(1));
        Ok(Self {
            displaced: (0..count).map(|k| k * cells / count).collect(),
            step: steps(&tessellation, positions, &acting, spacing),
            widest: widest(&tessellation, positions, &acting),
            acting,
            environment: Arc::new(environment(&tessellation, positions, spacing, &trusted)),
            trusted,
            unambiguous: unambiguous(&tessellation, positions, spacing),
            positions: positions.to_vec(),
            tessellation,
            spacing,
            reach,
        })
    }

    /// The largest force of one cell on another, and the largest ratio of one to the step of a cell it depends on.
    pub fn magnitudes(&self, model: &Model<f64>) -> [f64; 2] {
        let (mut polygon, mut scaled) = (CellPolygon::default(), CellPolygon::default());
        let mut forces = Vec::new();
        let (mut force, mut slope) = (0.0, 0.0);
        for &cell in self.displaced.iter().filter(|&&cell| self.acting[cell]) {
            polygon.fill(&self.tessellation, &self.positions, cell);
            forces.resize(polygon.len(), Vector::zeros());
            // Forces may happen to vanish at the very shape of the cell, not at another one too.
            let Shape { area, perimeter } = polygon.shape();
            let mut largest: f64 = 0.0;
            for size in [1.0, 2.0] {
                let shape = Shape { area: size * area, perimeter: size * perimeter };
                let site = model.site(cell, polygon.len(), self.positions[cell]);
                VertexForces::of_cell(model, site, shape).on_ring(&polygon, &mut forces);
                let ring = self.tessellation.ring(cell);
                let displacement = |h| self.tessellation.displacement(&self.positions, cell, h) * size.sqrt();
                scaled.fill_ring(ring.map(displacement));
                let element = CellElement {
                    cell,
                    neighbours: self.tessellation.neighbours(cell),
                    polygon: &scaled,
                    position: self.positions[cell],
                    domain: self.tessellation.domain(),
                    environment: &model.environment,
                };
                let mut on_cell = Vector::zeros();
                let on_ring = forces.as_mut_slice();
                ring_terms(&model.terms, &element, &mut RingForces { on_ring, on_cell: &mut on_cell });
                largest = forces.iter().chain([&on_cell]).map(|f| f.amax()).fold(largest, f64::max);
            }
            let neighbours = self.tessellation.neighbours(cell).iter();
            let step = neighbours.map(|&k| self.step[k as usize]).fold(self.step[cell], f64::min);
            (force, slope) = (largest.max(force), (largest / step).max(slope));
        }
        [force, slope]
    }

    /// Those of some cells that are not so close to a singular position that the step is lost in rounding.
    pub fn resolved(&self, cells: &[usize]) -> impl Iterator<Item = usize> {
        cells.iter().copied().filter(|&cell| self.step[cell] > SMALLEST_STEP * self.spacing)
    }

    /// Batches of cells to displace together, no two of which act on one cell through terms, with the cell that acts on
    /// each.
    pub fn batches(&self, cells: &[usize]) -> Vec<Batch> {
        let mut batches: Vec<Batch> = Vec::new();
        for cell in self.resolved(cells) {
            let reached = self.reached_from(cell);
            let free = |batch: &Batch| reached.iter().all(|&i| batch.moved_by[i].is_none());
            let at = batches.iter().position(free).unwrap_or_else(|| {
                batches.push(Batch { cells: Vec::new(), moved_by: vec![None; self.positions.len()] });
                batches.len() - 1
            });
            batches[at].cells.push(cell);
            for i in reached {
                batches[at].moved_by[i] = Some(cell);
            }
        }
        batches
    }

    /// Each cell on its own, acting on all.
    pub fn single(&self, cells: &[usize]) -> Vec<Batch> {
        let batch = |cell| Batch { cells: vec![cell], moved_by: vec![Some(cell); self.positions.len()] };
        self.resolved(cells).map(batch).collect()
    }

    /// The cell, its neighbours and their neighbours.
    fn reached_from(&self, cell: usize) -> Vec<usize> {
        let mut reached = vec![cell];
        for _ in 0..2 {
            let next: Vec<usize> = (reached.iter())
                .flat_map(|&i| self.tessellation.neighbours(i).iter().map(|&j| j as usize))
                .collect();
            reached.extend(next);
            reached.sort_unstable();
            reached.dedup();
        }
        reached
    }
}

/// Cells that are displaced together.
pub(super) struct Batch {
    pub cells: Vec<usize>,
    /// For each cell, the one of the batch that its velocity depends on.
    pub moved_by: Vec<Option<usize>>,
}

/// Data that effects refer to.
fn environment(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    spacing: f64,
    trusted: &[bool],
) -> Environment {
    let cells = positions.len();
    let origin = positions.iter().sum::<Vector<f64>>() / cells.max(1) as f64;
    let labels = (0..cells).map(|cell| [Some(1), Some(2), None, Some(1)].get(cell % 4).copied().flatten());
    let earlier = |cell: usize| {
        let phase = cell as f64;
        (!cell.is_multiple_of(5)).then(|| Vector::new(phase.sin(), (2.0 * phase).cos()))
    };
    let given = |environment: Environment| {
        let environment = environment
            .about(origin)
            .with_cell_size(spacing)?
            .with_labels(labels.collect())?
            .with_earlier((0..cells).map(earlier).collect())?;
        let Domain::Open = tessellation.domain() else {
            return Ok(environment);
        };
        let beyond = trusted.iter().map(|trusted| !trusted).collect();
        let environment = environment.with_beyond_edge(beyond)?;
        // One square that holds everything: between squares the field has kinks.
        let far = positions.iter().map(|r| (r - origin).amax()).fold(spacing, f64::max) * 1.1;
        let corner = origin - Vector::repeat(far);
        let values = [[1.0, 0.5], [-0.5, 0.2], [0.3, -1.0], [0.8, 0.9]].map(Vector::from).to_vec();
        match Grid::new([corner.x, corner.y], [2.0 * far; 2], [2, 2]) {
            Ok(grid) => VectorMap::new(grid, values).map(|map| environment.with_map(map)),
            Err(_) => Ok(environment),
        }
    };
    given(Environment::default()).unwrap_or_default()
}

/// Area of the rectangle around all positions.
fn extent(positions: &[Vector<f64>]) -> f64 {
    let mut corners = [Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY)];
    for r in positions {
        corners = [corners[0].inf(r), corners[1].sup(r)];
    }
    let size = corners[1] - corners[0];
    size.x * size.y
}

fn acting(tessellation: &Tessellation) -> Vec<bool> {
    let closed = |cell: usize| tessellation.is_closed(cell);
    let moves =
        |cell: usize| closed(cell) && tessellation.neighbours(cell).iter().all(|&k| closed(k as usize));
    let acts = |cell| moves(cell) || tessellation.neighbours(cell).iter().any(|&k| moves(k as usize));
    (0..tessellation.len()).map(|cell| closed(cell) && acts(cell)).collect()
}

fn widest(tessellation: &Tessellation, positions: &[Vector<f64>], acting: &[bool]) -> f64 {
    (0..positions.len())
        .filter(|&cell| acting[cell])
        .flat_map(|cell| tessellation.ring(cell).map(move |h| (cell, h)))
        .map(|(cell, h)| tessellation.displacement(positions, cell, h).norm())
        .fold(0.0, f64::max)
}

fn steps(tessellation: &Tessellation, positions: &[Vector<f64>], acting: &[bool], spacing: f64) -> Vec<f64> {
    let mut distance = vec![spacing; positions.len()];
    let mut polygon = CellPolygon::default();
    for cell in (0..tessellation.len()).filter(|&cell| acting[cell]) {
        let neighbours = tessellation.neighbours(cell);
        polygon.fill(tessellation, positions, cell);
        for (m, corner) in polygon.corners().iter().enumerate() {
            let twice_area = cross(corner.a, corner.b).abs();
            let next = if m + 1 == neighbours.len() { 0 } else { m + 1 };
            let [a, b] = [neighbours[m] as usize, neighbours[next] as usize];
            for (own, side) in [(cell, corner.a - corner.b), (a, corner.b), (b, corner.a)] {
                distance[own] = distance[own].min(twice_area / side.norm());
            }
        }
    }
    // A power of two adds to a coordinate without rounding.
    distance.into_iter().map(|distance| (distance * STEP).log2().floor().exp2()).collect()
}

fn unambiguous(tessellation: &Tessellation, positions: &[Vector<f64>], spacing: f64) -> Vec<bool> {
    let mut settled = vec![true; positions.len()];
    let mut polygon = CellPolygon::default();
    for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell)) {
        polygon.fill(tessellation, positions, cell);
        let neighbours = tessellation.neighbours(cell);
        let sides = neighbours.len();
        for (m, length) in polygon.side_lengths().enumerate() {
            let previous = if m == 0 { sides - 1 } else { m - 1 };
            let radius = polygon.corners()[m].centre.norm().max(polygon.corners()[previous].centre.norm());
            if length.abs() < 1e-9 * (spacing + radius * radius / spacing) {
                let next = if m + 1 == sides { 0 } else { m + 1 };
                settled[cell] = false;
                for k in [previous, m, next] {
                    settled[neighbours[k] as usize] = false;
                }
            }
        }
    }
    (0..positions.len())
        .map(|cell| settled[cell] && tessellation.neighbours(cell).iter().all(|&k| settled[k as usize]))
        .collect()
}
