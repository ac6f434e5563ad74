//! From elements to the velocities of all cells.
//!
//! Each element writes the forces on its ring into its own half-edges; each cell then gathers what its neighbours wrote
//! about it, in the order of its ring. No two threads write to one place and no sum depends on their number. Where only sums are asked for,
//! what cells of a chunk write for each other stays in the cache, and what goes from chunk to chunk passes through memory.

use crate::chunk::{CHUNK, split_by_cells};
use crate::element::elements_of;
use crate::element_lanes::{elements_in_lanes, fit_lanes};
use crate::mirrors::signs_of;
use crate::{Environment, Model, Term};
use rayon::prelude::*;
use std::ops::Range;
use std::slice::from_ref;
use std::sync::Arc;
use voronudge_geometry::{CellPolygon, Scalar, Tessellation, Vector};

/// The work space of velocities. Reusable from call to call.
#[derive(Debug, Clone)]
pub struct VelocityAssembly<S> {
    /// What the elements of a chunk wrote for their rings.
    on_rings: Vec<Vector<S>>,
    /// What passes between chunks.
    passing: Vec<Passing<S>>,
    /// Where what concerns a cell with neighbours in another chunk begins among what its own chunk passes on.
    begins: Vec<u32>,
}

/// Cells of a chunk that have neighbours in others, and for each neighbour of such a cell one force: that of the neighbour on the cell if it belongs
/// to the same chunk, else that of the cell on the neighbour.
#[derive(Debug, Clone)]
struct Passing<S> {
    cells: Vec<u32>,
    forces: Vec<Vector<S>>,
}

impl<S: Scalar> Default for VelocityAssembly<S> {
    fn default() -> Self {
        Self { on_rings: Vec::new(), passing: Vec::new(), begins: Vec::new() }
    }
}

impl<S> Default for Passing<S> {
    fn default() -> Self {
        Self { cells: Vec::new(), forces: Vec::new() }
    }
}

impl<S: Scalar> VelocityAssembly<S> {
    /// The velocities of the terms alone.
    pub(crate) fn evaluate_terms(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<S>],
        model: &Model<S>,
        velocities: &mut Vec<Vector<S>>,
    ) {
        let evaluate = |cells: Range<usize>, forces: &mut [Vector<S>], velocities: &mut [Vector<S>]| {
            elements(tessellation, positions, from_ref(model), cells, forces, velocities);
        };
        self.assemble(tessellation, velocities, evaluate);
    }

    /// Lets elements write what they have for their rings and for their cells, chunk by chunk, and adds up what there is for each cell.
    pub(crate) fn assemble(
        &mut self,
        tessellation: &Tessellation,
        sums: &mut Vec<Vector<S>>,
        elements: impl Fn(Range<usize>, &mut [Vector<S>], &mut [Vector<S>]) + Sync,
    ) {
        let nan = Vector::new(S::constant(f64::NAN), S::constant(f64::NAN));
        let cells = tessellation.len();
        sums.resize(cells, nan);
        if cells <= CHUNK {
            self.on_rings.resize(tessellation.half_edges(), nan);
            elements(0..cells, &mut self.on_rings, sums);
            for (cell, sum) in sums.iter_mut().enumerate() {
                *sum = tessellation.twins(cell).fold(*sum, |sum, twin| sum + self.on_rings[twin]);
            }
            return;
        }
        self.begins.resize(cells, 0);
        self.passing.resize_with(cells.div_ceil(CHUNK), Passing::default);
        // What a chunk wrote is still in the cache when its own cells gather it; the others wait until all have written.
        let passing = self.passing.par_iter_mut().zip(self.begins.par_chunks_mut(CHUNK));
        passing.zip(sums.par_chunks_mut(CHUNK)).enumerate().for_each_init(
            Vec::new,
            |on_rings, (chunk, ((passing, begins), sums))| {
                let range = chunk * CHUNK..chunk * CHUNK + sums.len();
                let first = tessellation.half_edge_start(range.start);
                on_rings.resize(tessellation.half_edge_start(range.end) - first, nan);
                elements(range.clone(), on_rings, sums);
                passing.cells.clear();
                passing.forces.clear();
                gather(tessellation, range.clone(), on_rings, sums, |cell| {
                    begins[cell - range.start] = passing.forces.len() as u32;
                    passing.cells.push(cell as u32);
                    let sides = tessellation.ring(cell).zip(tessellation.twins(cell));
                    passing.forces.extend(sides.map(|(h, twin)| {
                        let [own, others] = [h, twin].map(|h| h.wrapping_sub(first));
                        on_rings[if others < on_rings.len() { others } else { own }]
                    }));
                });
            },
        );
        let (passing, begins) = (&self.passing, &self.begins);
        sums.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, sums)| {
            let mut own = 0;
            for &cell in &passing[chunk].cells {
                let sum = &mut sums[cell as usize - chunk * CHUNK];
                for h in tessellation.ring(cell as usize) {
                    let other = tessellation.neighbour(h);
                    // Which it is cannot be foreseen, so there is no branch.
                    let passed = begins[other] as usize + tessellation.twin_place(h);
                    let at = if other / CHUNK == chunk { own } else { passed };
                    *sum += passing[other / CHUNK].forces[at];
                    own += 1;
                }
            }
        });
    }
}

/// Forces of every cell on its neighbours, one per half-edge. Reusable from call to call.
#[derive(Debug, Clone)]
pub struct HalfEdgeForces<S> {
    forces: Vec<Vector<S>>,
}

impl<S: Scalar> Default for HalfEdgeForces<S> {
    fn default() -> Self {
        Self { forces: Vec::new() }
    }
}

impl<S: Scalar> HalfEdgeForces<S> {
    /// Velocities of the first cells of a tessellation, as many as `velocities` has, of which the others are mirror images: as many
    /// again behind one mirror, or three times as many behind two mirrors and behind both. Component `k` of a vector is reversed by
    /// mirror `k` of `mirrors`.
    ///
    /// Only the cells themselves act. Images move with them, so a force on an image is a mirrored force on its cell; by that,
    /// vertices on a mirror move along it. Between mirrors the model has shape terms only; with none these are all cells.
    pub fn evaluate_with_images(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<S>],
        model: &Model<S>,
        mirrors: &[usize],
        velocities: &mut [Vector<S>],
    ) {
        let cells = velocities.len();
        self.write(tessellation, positions, model, velocities);
        let images = tessellation.len() / cells.max(1);
        let gathered = velocities.par_iter_mut().enumerate().with_min_len(CHUNK);
        gathered.for_each(|(cell, sum)| {
            for image in 0..images {
                let ([x, y], own) = (signs_of(image, mirrors), image * cells + cell);
                for (other, twin) in tessellation.neighbours(own).iter().zip(tessellation.twins(own)) {
                    if (*other as usize) < cells {
                        let force = self.forces[twin];
                        *sum += Vector::new(force.x * x, force.y * y);
                    }
                }
            }
        });
    }

    /// The forces at some positions.
    pub fn of(tessellation: &Tessellation, positions: &[Vector<S>], model: &Model<S>) -> Self {
        let mut forces = Self::default();
        forces.write(tessellation, positions, model, &mut vec![zero(); tessellation.len()]);
        forces
    }

    /// Writes the forces of the elements of the first cells, as many as `on_cells` has, on their rings and on the cells.
    fn write(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<S>],
        model: &Model<S>,
        on_cells: &mut [Vector<S>],
    ) {
        let cells = on_cells.len();
        self.forces.resize(tessellation.half_edge_start(cells), zero());
        split_by_cells(&mut self.forces, cells, |cell| tessellation.half_edge_start(cell))
            .into_par_iter()
            .zip(on_cells.par_chunks_mut(CHUNK))
            .for_each(|((range, forces), on_cells)| {
                elements(tessellation, positions, from_ref(model), range, forces, on_cells);
            });
    }

    /// The force of the half-edge's cell on the neighbour it points at.
    #[inline]
    pub fn on_neighbour(&self, half_edge: usize) -> Vector<S> {
        self.forces[half_edge]
    }
}

fn zero<S: Scalar>() -> Vector<S> {
    Vector::new(S::constant(0.0), S::constant(0.0))
}

/// Adds what the neighbours of some cells wrote for them, if all of it stands among what these cells wrote; tells of cells for which it does not.
fn gather<S: Scalar>(
    tessellation: &Tessellation,
    cells: Range<usize>,
    on_rings: &[Vector<S>],
    sums: &mut [Vector<S>],
    mut incomplete: impl FnMut(usize),
) {
    let first = tessellation.half_edge_start(cells.start);
    for (cell, sum) in cells.zip(sums) {
        let (mut total, mut complete) = (*sum, true);
        for twin in tessellation.twins(cell) {
            // Twins before the stretch are far beyond its end.
            let at = twin.wrapping_sub(first);
            let is_here = at < on_rings.len();
            complete &= is_here;
            total += on_rings[if is_here { at } else { 0 }];
        }
        if complete {
            *sum = total;
        } else {
            incomplete(cell);
        }
    }
}

/// The elements of some cells, a chunk at most, under some models: for each cell the forces on its ring, one model after another, and those on the cell itself.
fn elements<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    models: &[Model<S>],
    cells: Range<usize>,
    forces: &mut [Vector<S>],
    on_cells: &mut [Vector<S>],
) {
    if fit_lanes(models) {
        return elements_in_lanes(tessellation, positions, models, cells, forces, on_cells);
    }
    let mut polygon = CellPolygon::default();
    let mut rest = forces;
    for (cell, on_cell) in cells.zip(on_cells.chunks_exact_mut(models.len())) {
        let (own, after) = rest.split_at_mut(models.len() * tessellation.ring(cell).len());
        rest = after;
        elements_of(cell, tessellation, positions, models, &mut polygon, own, on_cell);
    }
}

/// The velocity field of each term for a coefficient of one: velocities are linear in the coefficients. Polygons are made once for all terms.
pub fn columns(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    terms: &[Term],
    environment: &Arc<Environment>,
) -> Vec<Vec<Vector<f64>>> {
    let (count, cells) = (terms.len(), tessellation.len());
    let models: Vec<Model<f64>> = terms.iter().map(|&term| Model::single(term).within(environment)).collect();
    let mut forces = vec![Vector::zeros(); count * tessellation.half_edges()];
    let mut on_cells = vec![Vector::zeros(); count * cells];
    if count > 0 {
        split_by_cells(&mut forces, cells, |cell| count * tessellation.half_edge_start(cell))
            .into_par_iter()
            .zip(on_cells.par_chunks_mut(count * CHUNK))
            .for_each(|((range, forces), on_cells)| {
                elements(tessellation, positions, &models, range, forces, on_cells);
            });
    }
    let column = |term: usize| -> Vec<Vector<f64>> {
        let of_cell = |cell: usize| {
            let mut v = on_cells[count * cell + term];
            for (h, neighbour) in tessellation.ring(cell).zip(tessellation.neighbours(cell)) {
                let other = tessellation.ring(*neighbour as usize);
                v += forces[count * other.start + term * other.len() + tessellation.twin_place(h)];
            }
            v
        };
        (0..cells).map(of_cell).collect()
    };
    (0..count).map(column).collect()
}
