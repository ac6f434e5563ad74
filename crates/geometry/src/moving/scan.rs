//! One pass over all cells: is the tessellation still that of the positions?

use super::diagonal::Site;
use super::hull::turns_once;
use super::split::CHUNK;
use crate::domain::MOST_BOXES;
use crate::{Arithmetic, BySides, Domain, Lanes, Tessellation, Vector, cross, dot};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

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

/// What a scan found.
pub(super) enum Finding {
    /// Every triangle is counter-clockwise. These edges are not, or to rounding not surely, Delaunay edges; all others
    /// are. If there are none, the tessellation is that of the positions.
    Suspects(Vec<Edge>),
    /// A triangle is turned over, or to rounding flat; or cells are too far from the box; or those of an open field have another hull.
    Inverted,
}

/// Looks at every triangle and every edge of a tessellation.
///
/// Triangles that are all counter-clockwise cover the torus once, because their images are those of a tessellation of it, and so they do the
/// inside of a hull that they have as they had; edges that are all locally Delaunay then make the Delaunay triangulation. The pass is thus a proof.
pub(super) fn scan(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Finding {
    let extent = positions
        .par_chunks(CHUNK)
        .map(|chunk| chunk.iter().map(|r| r.x.abs().max(r.y.abs())).fold(0.0, f64::max))
        .reduce(|| 0.0, f64::max);
    let size = match tessellation.domain() {
        Domain::Periodic(cell_box) => {
            let [width, height] = cell_box.lengths();
            // Images are counted in 16 bits.
            if extent > MOST_BOXES * width.min(height) {
                return Finding::Inverted;
            }
            2.0 * extent + width + height + cell_box.offset().abs()
        }
        Domain::Open if turns_once(tessellation, positions) => 2.0 * extent,
        Domain::Open => return Finding::Inverted,
    };
    let chunks = positions.len().div_ceil(CHUNK);
    let findings: Option<Vec<Vec<Edge>>> = (0..chunks)
        .into_par_iter()
        .map(|chunk| {
            let last = ((chunk + 1) * CHUNK).min(positions.len());
            scan_cells(tessellation, positions, size, chunk * CHUNK..last)
        })
        .collect();
    findings.map_or(Finding::Inverted, |lists| Finding::Suspects(lists.concat()))
}

fn scan_cells(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    size: f64,
    cells: std::ops::Range<usize>,
) -> Option<Vec<Edge>> {
    let by_sides = BySides::new(tessellation, cells);
    let mut doubtful: Vec<usize> = by_sides.others().collect();
    Arch::new().dispatch(Proof { by_sides: &by_sides, positions, size, doubtful: &mut doubtful });
    doubtful.sort_unstable();
    let mut suspects = Vec::new();
    for cell in doubtful {
        scan_cell(tessellation, positions, size, cell, &mut suspects)?;
    }
    Some(suspects)
}

/// Proves cells, and leaves the others to [`scan_cell`].
struct Proof<'a> {
    by_sides: &'a BySides<'a>,
    positions: &'a [Vector<f64>],
    size: f64,
    doubtful: &'a mut Vec<usize>,
}

impl WithSimd for Proof<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<A: Simd>(self, _: A) {
        let zero = Lanes::constant(0.0);
        let mut ring = [Vector::new(zero, zero); BySides::MOST_SIDES];
        for sides in 3..=BySides::MOST_SIDES {
            for batch in self.by_sides.batches(sides) {
                batch.fill_ring(self.positions, &mut ring[..sides], Lanes::put);
                let proven = Extremes::of(&ring[..sides]).prove(self.size);
                batch.each(|lane, cell| {
                    if !proven[lane] {
                        self.doubtful.push(cell);
                    }
                });
            }
        }
    }
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

impl<S: Ordered> Extremes<S> {
    #[inline(always)]
    fn of(ring: &[Vector<S>]) -> Self {
        let lifted = |m: usize| (ring[m], dot(ring[m], ring[m]));
        let (far, zero) = (S::constant(f64::INFINITY), S::constant(0.0));
        let mut extremes = Self { cross: far, determinant: far, farthest: zero, total: zero };
        let (mut before, mut here) = (lifted(ring.len() - 1), lifted(0));
        let mut first = cross(before.0, here.0);
        for m in 0..ring.len() {
            let after = lifted(if m + 1 == ring.len() { 0 } else { m + 1 });
            let second = cross(here.0, after.0);
            extremes.cross = second.least(extremes.cross);
            extremes.determinant =
                determinant(before, here, after, first, second).least(extremes.determinant);
            extremes.farthest = here.1.most(extremes.farthest);
            extremes.total += here.1;
            (before, here, first) = (here, after, second);
        }
        extremes
    }
}

impl Extremes<f64> {
    /// Of the ring of a cell on the hull, which goes from the next cell of the hull to the one before: where the hull is no longer convex there, the cross
    /// product of these two tells. Its edges are for [`scan_cell`].
    fn of_open(ring: &[Vector<f64>]) -> Self {
        let ends = [ring[0], ring[ring.len() - 1]];
        let pairs = ring.windows(2).chain([&ends[..]]);
        let squares = || ring.iter().map(|r| dot(*r, *r));
        Self {
            cross: pairs
                .map(|pair| cross(pair[0], pair[1]))
                .fold(f64::INFINITY, |least, own| own.least(least)),
            determinant: 0.0,
            farthest: squares().fold(0.0, f64::max),
            total: squares().sum(),
        }
    }
}

impl Extremes<Lanes> {
    #[inline(always)]
    fn prove(&self, size: f64) -> [bool; Lanes::WIDTH] {
        std::array::from_fn(|lane| {
            let of = |lanes: Lanes| lanes.0[lane];
            let [cross, determinant, farthest, total] =
                [self.cross, self.determinant, self.farthest, self.total].map(of);
            Extremes { cross, determinant, farthest, total }.is_proven(size)
        })
    }
}

impl Extremes<f64> {
    fn is_turned(&self, size: f64) -> bool {
        !(self.cross > CROSS_MARGIN * size * self.farthest.sqrt() && self.total < f64::INFINITY)
    }

    fn margin(&self, size: f64) -> f64 {
        DETERMINANT_MARGIN * size * self.farthest.sqrt() * self.farthest
    }

    #[inline(always)]
    fn is_proven(&self, size: f64) -> bool {
        !self.is_turned(size) && self.determinant > self.margin(size)
    }
}

/// Finds the suspects among the edges of one cell.
fn scan_cell(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    size: f64,
    cell: usize,
    suspects: &mut Vec<Edge>,
) -> Option<()> {
    let ring: Vec<Vector<f64>> = tessellation.displacements(positions, cell).collect();
    let is_closed = tessellation.is_closed(cell);
    if ring.len() < if is_closed { 3 } else { 2 } {
        return None;
    }
    let extremes = if is_closed { Extremes::of(&ring) } else { Extremes::of_open(&ring) };
    if extremes.is_turned(size) {
        return None;
    }
    let lifted = |m: usize| (ring[m % ring.len()], dot(ring[m % ring.len()], ring[m % ring.len()]));
    // The edges of the hull are between no two triangles.
    let inner = if is_closed { 0..ring.len() } else { 1..ring.len() - 1 };
    for (m, h) in inner.clone().zip(tessellation.ring(cell).skip(inner.start)) {
        let [before, here, after] = [m + ring.len() - 1, m, m + 1].map(lifted);
        let (first, second) = (cross(before.0, here.0), cross(here.0, after.0));
        if determinant(before, here, after, first, second) <= extremes.margin(size) {
            let (other, image) = (tessellation.neighbour[h], tessellation.image[h]);
            // Each edge from one end only.
            if (other, image) > (cell as u32, [0, 0]) {
                suspects.push(Edge { from: cell as u32, to: (other, image) });
            }
        }
    }
    Some(())
}

/// A neighbour relative to the cell, and the square of its distance.
type Lifted<S> = (Vector<S>, S);

/// `a² (b × c) − b² (a × c) + c² (a × b)`, given the cross products of the two triangles (0, a, b) and (0, b, c): positive if
/// the edge between them, from the cell at 0 to b, is a Delaunay edge. c then lies outside the circle through 0, a and b.
#[inline(always)]
fn determinant<S: Arithmetic>(
    (a, a2): Lifted<S>,
    (_, b2): Lifted<S>,
    (c, c2): Lifted<S>,
    a_cross_b: S,
    b_cross_c: S,
) -> S {
    a2 * b_cross_c - b2 * cross(a, c) + c2 * a_cross_b
}

/// Numbers with a smaller and a larger one of two; that of a NaN and a number is the number if the NaN comes first.
trait Ordered: Arithmetic {
    fn least(self, other: Self) -> Self;
    fn most(self, other: Self) -> Self;
}

impl Ordered for f64 {
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn most(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl Ordered for Lanes {
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.with(other, f64::least)
    }

    #[inline(always)]
    fn most(self, other: Self) -> Self {
        self.with(other, f64::most)
    }
}
