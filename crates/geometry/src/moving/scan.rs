//! One pass over all cells: is the tessellation still that of the positions?

use super::diagonal::Site;
use super::hull::turns_once;
use super::split::CHUNK;
use crate::domain::MOST_BOXES;
use crate::{Arithmetic, BySides, Domain, Lanes, Tessellation, Vector};
use pulp::{Arch, Scalar, Simd, WithSimd};
use rayon::prelude::*;
use smallvec::SmallVec;
use std::cmp::Ordering;
use std::ops::Range;

/// Bounds of the rounding errors of a cross product and of the in-circle determinant, in units of
/// ε · (largest coordinate) · (length of the ring)^n. Four displacements, each rounded thrice at the size of the
/// coordinates, enter the determinant with slopes of at most 9 (length)³.
const CROSS_MARGIN: f64 = 24.0 * f64::EPSILON;
const DETERMINANT_MARGIN: f64 = 256.0 * f64::EPSILON;

/// A Delaunay edge as seen from one of its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    pub from: u32,
    pub to: Site,
}

/// Looks at every triangle and every edge of a tessellation.
///
/// Triangles that are all counter-clockwise cover the torus once, because their images are those of a tessellation of it, and so they do the
/// inside of a hull that they have as they had; edges that are all locally Delaunay then make the Delaunay triangulation. A scan of all cells is thus a
/// proof.
pub(super) struct Scan<'a> {
    pub tessellation: &'a Tessellation,
    pub positions: &'a [Vector<f64>],
    /// Of the numbers from which displacements are made.
    size: f64,
}

impl<'a> Scan<'a> {
    /// `None` if cells are too far from the box, or those of an open field have another hull.
    pub fn new(tessellation: &'a Tessellation, positions: &'a [Vector<f64>]) -> Option<Self> {
        let extent = positions.par_chunks(CHUNK).map(extent).reduce(|| 0.0, f64::max);
        let size = match tessellation.domain() {
            Domain::Periodic(cell_box) => {
                let [width, height] = cell_box.lengths();
                // Images are counted in 16 bits.
                let is_near = extent <= MOST_BOXES * width.min(height);
                is_near.then(|| 2.0 * extent + width + height + cell_box.offset().abs())?
            }
            Domain::Open => turns_once(tessellation, positions).then_some(2.0 * extent)?,
        };
        Some(Self { tessellation, positions, size })
    }

    /// Adds the edges of some cells that are not, or to rounding not surely, Delaunay edges. `None` if a triangle of theirs is turned over, or to
    /// rounding flat. If no cell has a suspect, the tessellation is that of the positions.
    pub fn suspects(&self, cells: Range<usize>, suspects: &mut Vec<Edge>) -> Option<()> {
        let by_sides = BySides::new(self.tessellation, cells);
        let mut doubtful: Vec<usize> = by_sides.others().collect();
        let (positions, size) = (self.positions, self.size);
        Arch::new().dispatch(Proof { by_sides: &by_sides, positions, size, doubtful: &mut doubtful });
        doubtful.sort_unstable();
        doubtful.into_iter().try_for_each(|cell| self.suspects_of(cell, suspects))
    }

    fn suspects_of(&self, cell: usize, suspects: &mut Vec<Edge>) -> Option<()> {
        let one = Scalar::new();
        let lifted = |d: Vector<f64>| Lifted::new(one, [d.x, d.y]);
        let tessellation = self.tessellation;
        let ring: SmallVec<[Lifted<f64>; 16]> =
            tessellation.displacements(self.positions, cell).map(lifted).collect();
        let is_closed = tessellation.is_closed(cell);
        if ring.len() < if is_closed { 3 } else { 2 } {
            return None;
        }
        let extremes = if is_closed { Extremes::of(one, &ring) } else { Extremes::of_open(one, &ring) };
        let [flat, tied] = extremes.margins(one, self.size);
        if extremes.cross.partial_cmp(&flat) != Some(Ordering::Greater) || !extremes.total.is_finite() {
            return None;
        }
        // The edges of the hull are between no two triangles.
        let inner = if is_closed { 0..ring.len() } else { 1..ring.len() - 1 };
        for (m, h) in inner.clone().zip(tessellation.ring(cell).skip(inner.start)) {
            let [before, here, after] = [m + ring.len() - 1, m, m + 1].map(|m| ring[m % ring.len()]);
            let crosses = [before.cross(one, here), here.cross(one, after)];
            if determinant(one, [before, here, after], crosses) <= tied {
                let (other, image) = (tessellation.neighbour[h], tessellation.image[h]);
                // Each edge from one end only.
                if (other, image) > (cell as u32, [0, 0]) {
                    suspects.push(Edge { from: cell as u32, to: (other, image) });
                }
            }
        }
        Some(())
    }
}

/// The largest coordinate, in eight maxima side by side.
fn extent(positions: &[Vector<f64>]) -> f64 {
    let mut most = [[0.0; 2]; 4];
    for four in positions.chunks(most.len()) {
        for (most, r) in most.iter_mut().zip(four) {
            for (most, x) in most.iter_mut().zip([r.x.abs(), r.y.abs()]) {
                *most = if x > *most { x } else { *most };
            }
        }
    }
    most.into_iter().flatten().fold(0.0, f64::max)
}

/// Proves cells, and leaves the others to [`Scan::suspects_of`].
struct Proof<'a> {
    by_sides: &'a BySides<'a>,
    positions: &'a [Vector<f64>],
    size: f64,
    doubtful: &'a mut Vec<usize>,
}

impl WithSimd for Proof<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<A: Simd>(self, simd: A) {
        let zero = Lanes::constant(0.0);
        let mut ring = [Vector::new(zero, zero); BySides::MOST_SIDES];
        let mut registers = [Lifted::new(simd, [simd.splat_f64s(0.0); 2]); BySides::MOST_SIDES];
        for sides in 3..=BySides::MOST_SIDES {
            for batch in self.by_sides.batches(sides) {
                batch.fill_ring(self.positions, &mut ring[..sides], Lanes::put);
                let proven = prove(simd, &ring[..sides], &mut registers[..sides], self.size);
                batch.each(|lane, cell| {
                    if !proven[lane] {
                        self.doubtful.push(cell);
                    }
                });
            }
        }
    }
}

/// Which of several rings are proven, in as many registers as they fill.
#[inline(always)]
fn prove<A: Simd>(
    simd: A,
    ring: &[Vector<Lanes>],
    registers: &mut [Lifted<A::f64s>],
    size: f64,
) -> [bool; Lanes::WIDTH] {
    let mut proofs = [0.0; Lanes::WIDTH];
    for first in (0..Lanes::WIDTH).step_by(A::F64_LANES) {
        let lanes = first..(first + A::F64_LANES).min(Lanes::WIDTH);
        for (own, d) in registers.iter_mut().zip(ring) {
            let x = simd.partial_load_f64s(&d.x.0[lanes.clone()]);
            let y = simd.partial_load_f64s(&d.y.0[lanes.clone()]);
            *own = Lifted::new(simd, [x, y]);
        }
        let proof = Extremes::of(simd, registers).proof(simd, size);
        simd.partial_store_f64s(&mut proofs[lanes], proof);
    }
    proofs.map(|proof| proof > 0.0)
}

/// What proves a ring: the smallest cross product of consecutive neighbours, the smallest in-circle determinant and the largest square of a
/// distance. Extrema pass over NaN, the sum of the squares does not.
#[derive(Clone, Copy)]
struct Extremes<S> {
    cross: S,
    determinant: S,
    farthest: S,
    total: S,
}

impl<S: Copy> Extremes<S> {
    #[inline(always)]
    fn of<A: Simd<f64s = S>>(simd: A, ring: &[Lifted<S>]) -> Self {
        let (far, zero) = (simd.splat_f64s(f64::INFINITY), simd.splat_f64s(0.0));
        let mut extremes = Self { cross: far, determinant: far, farthest: zero, total: zero };
        let (mut before, mut here) = (ring[ring.len() - 1], ring[0]);
        let mut first = before.cross(simd, here);
        for m in 0..ring.len() {
            let after = ring[if m + 1 == ring.len() { 0 } else { m + 1 }];
            let second = here.cross(simd, after);
            extremes.cross = simd.min_f64s(second, extremes.cross);
            let determinant = determinant(simd, [before, here, after], [first, second]);
            extremes.determinant = simd.min_f64s(determinant, extremes.determinant);
            extremes.farthest = simd.max_f64s(here.square, extremes.farthest);
            extremes.total = simd.add_f64s(extremes.total, here.square);
            (before, here, first) = (here, after, second);
        }
        extremes
    }

    /// Below which the cross product, and the determinant, may be zero.
    #[inline(always)]
    fn margins<A: Simd<f64s = S>>(&self, simd: A, size: f64) -> [S; 2] {
        let reach = simd.mul_f64s(simd.splat_f64s(size), simd.sqrt_f64s(self.farthest));
        let volume = simd.mul_f64s(reach, self.farthest);
        [
            simd.mul_f64s(simd.splat_f64s(CROSS_MARGIN), reach),
            simd.mul_f64s(simd.splat_f64s(DETERMINANT_MARGIN), volume),
        ]
    }

    /// Positive if every triangle is surely counter-clockwise and every edge surely a Delaunay edge.
    #[inline(always)]
    fn proof<A: Simd<f64s = S>>(&self, simd: A, size: f64) -> S {
        let [flat, tied] = self.margins(simd, size);
        let turns = simd.sub_f64s(self.cross, flat);
        let opens = simd.sub_f64s(self.determinant, tied);
        // Where numbers are too large, or are none, this is none.
        let sound = simd.mul_f64s(simd.add_f64s(self.total, opens), simd.splat_f64s(0.0));
        simd.add_f64s(simd.min_f64s(turns, opens), sound)
    }
}

impl Extremes<f64> {
    /// Of the ring of a cell on the hull, which goes from the next cell of the hull to the one before: where the hull is no longer convex there, the cross
    /// product of these two tells. Its edges are for [`Scan::suspects_of`].
    fn of_open(one: Scalar, ring: &[Lifted<f64>]) -> Self {
        let ends = [ring[0], ring[ring.len() - 1]];
        let pairs = ring.windows(2).chain([&ends[..]]);
        let squares = || ring.iter().map(|own| own.square);
        Self {
            cross: pairs.map(|pair| pair[0].cross(one, pair[1])).fold(f64::INFINITY, f64::min),
            determinant: 0.0,
            farthest: squares().fold(0.0, f64::max),
            total: squares().sum(),
        }
    }
}

/// A neighbour relative to the cell, and the square of its distance.
#[derive(Clone, Copy)]
struct Lifted<S> {
    at: [S; 2],
    square: S,
}

impl<S: Copy> Lifted<S> {
    #[inline(always)]
    fn new<A: Simd<f64s = S>>(simd: A, at: [S; 2]) -> Self {
        Self { at, square: simd.add_f64s(simd.mul_f64s(at[0], at[0]), simd.mul_f64s(at[1], at[1])) }
    }

    #[inline(always)]
    fn cross<A: Simd<f64s = S>>(self, simd: A, other: Self) -> S {
        let ([x, y], [u, v]) = (self.at, other.at);
        simd.sub_f64s(simd.mul_f64s(x, v), simd.mul_f64s(y, u))
    }
}

/// `a² (b × c) − b² (a × c) + c² (a × b)`, given the cross products of the two triangles (0, a, b) and (0, b, c): positive if
/// the edge between them, from the cell at 0 to b, is a Delaunay edge. c then lies outside the circle through 0, a and b.
#[inline(always)]
fn determinant<S: Copy, A: Simd<f64s = S>>(
    simd: A,
    [a, b, c]: [Lifted<S>; 3],
    [a_cross_b, b_cross_c]: [S; 2],
) -> S {
    let first = simd.mul_f64s(a.square, b_cross_c);
    let second = simd.mul_f64s(b.square, a.cross(simd, c));
    let third = simd.mul_f64s(c.square, a_cross_b);
    simd.add_f64s(simd.sub_f64s(first, second), third)
}
