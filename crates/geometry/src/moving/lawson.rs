//! Lawson's flips: edges that are not Delaunay edges are exchanged for the other diagonal until none is left.
//!
//! Cells are divided into parts by number. Flips among the cells of one part touch no ring of another, so parts flip side by side, and what
//! concerns several waits until all have done. The order of flips does not matter: there is one Delaunay triangulation.

use super::diagonal::{Site, is_delaunay};
use super::scan::{Edge, Scan};
use super::split::CHUNK;
use crate::{Tessellation, Vector};
use rayon::prelude::*;
use smallvec::SmallVec;

/// A cell that no flip has touched.
const UNTOUCHED: u32 = u32::MAX;

/// Flips per cell after which a triangulation is given up: a disordered one needs about one.
const FLIPS_PER_CELL: usize = 50;

/// The ring of a cell, mostly without memory of its own.
pub(super) type Ring = SmallVec<[Site; 10]>;

/// The flips did not come to an end: rounding, or triangles that are turned over, or cells on a circle in an open field.
pub(super) struct Tangled;

/// The rings that flips have changed, apart from the arrays of the tessellation. Memory is kept from call to call.
#[derive(Debug, Clone, Default)]
pub(super) struct Lawson {
    parts: Vec<Part>,
    /// Edges that may not be Delaunay edges, of each part and of all.
    waiting: Vec<Waiting>,
    pub(super) queue: Vec<Edge>,
}

/// The changed rings of [`CHUNK`] cells.
#[derive(Debug, Clone, Default)]
pub(super) struct Part {
    /// For each cell, its place in `rings`.
    slot: Vec<u32>,
    /// The cells touched.
    touched: Vec<u32>,
    rings: Vec<Ring>,
    /// By how many half-edges there are more.
    growth: i32,
}

/// Edges of a part that are to be looked at, and those to be flipped whose triangles reach into other parts.
#[derive(Debug, Clone, Default)]
struct Waiting {
    queue: Vec<Edge>,
    left: Vec<Edge>,
}

/// The rings of the cells of some parts in a row, of which the first is given: what flips may change.
struct Reach<'a> {
    tessellation: &'a Tessellation,
    first: usize,
    parts: &'a mut [Part],
}

impl Lawson {
    /// Flips until every edge is a Delaunay edge. Returns the number of flips. Each part is flipped as soon as it was looked at.
    pub fn settle(&mut self, scan: &Scan<'_>) -> Result<usize, Tangled> {
        let Scan { tessellation, positions, .. } = *scan;
        let cells = tessellation.len();
        self.resize(cells);
        let of_parts = self.parts.par_iter_mut().zip(&mut self.waiting).enumerate();
        let flips: Option<usize> = of_parts
            .map(|(first, (part, waiting))| {
                part.forget();
                let Waiting { queue, left } = waiting;
                queue.clear();
                left.clear();
                scan.suspects(first * CHUNK..((first + 1) * CHUNK).min(cells), queue)?;
                queue.reverse();
                let parts = std::slice::from_mut(part);
                Reach { tessellation, first, parts }.flip_all(positions, queue, left).ok()
            })
            .sum();
        let flips = flips.ok_or(Tangled)?;
        for waiting in self.waiting.iter().rev() {
            self.queue.extend(waiting.left.iter().rev());
        }
        let flips = flips + self.flip_all(tessellation, positions)?;
        if flips > 0 {
            self.conclude(tessellation);
        }
        Ok(flips)
    }

    /// Forgets all changes, of so many cells from now on.
    pub fn begin(&mut self, cells: usize) {
        self.resize(cells);
        self.parts.iter_mut().for_each(Part::forget);
    }

    fn resize(&mut self, cells: usize) {
        let parts = cells.div_ceil(CHUNK);
        self.parts.resize_with(parts, Part::default);
        self.waiting.resize_with(parts, Waiting::default);
        self.queue.clear();
        for (k, part) in self.parts.iter_mut().enumerate() {
            let own = CHUNK.min(cells - k * CHUNK);
            if part.slot.len() != own {
                *part = Part { slot: vec![UNTOUCHED; own], ..Part::default() };
            }
        }
    }

    /// Flips until no edge is left that may not be a Delaunay edge.
    pub fn flip_all(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
    ) -> Result<usize, Tangled> {
        let mut all = Reach { tessellation, first: 0, parts: &mut self.parts };
        all.flip_all(positions, &mut self.queue, &mut Vec::new())
    }

    /// Lets the rings that have changed begin as those of a tessellation do, and counts and orders them.
    pub fn conclude(&mut self, tessellation: &Tessellation) {
        self.parts.par_iter_mut().enumerate().for_each(|(k, part)| {
            part.touched.sort_unstable();
            part.growth = 0;
            for cell in part.touched.iter().map(|cell| *cell as usize) {
                let ring = &mut part.rings[part.slot[cell - k * CHUNK] as usize];
                part.growth += ring.len() as i32 - tessellation.ring(cell).len() as i32;
                if tessellation.is_closed(cell) {
                    let lowest = (0..ring.len()).min_by_key(|&m| ring[m]).unwrap_or(0);
                    ring.rotate_left(lowest);
                }
            }
        });
    }

    /// The changed rings in parts of [`CHUNK`] cells.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The new ring of a cell, from its lowest neighbour on or along the hull, if flips have changed it.
    #[inline]
    pub fn ring(&self, cell: usize) -> Option<&[Site]> {
        self.parts[cell / CHUNK].ring(cell)
    }

    /// Exchanges the diagonal between the first and the third of four counter-clockwise sites for the other. False if the
    /// rings are not those of a triangulation.
    pub(super) fn flip(&mut self, tessellation: &Tessellation, sites: [Site; 4]) -> bool {
        Reach { tessellation, first: 0, parts: &mut self.parts }.flip(sites, &mut self.queue)
    }

    pub(super) fn touch(&mut self, tessellation: &Tessellation, cell: u32) -> &mut Ring {
        self.parts[cell as usize / CHUNK].touch(tessellation, cell)
    }
}

impl Part {
    /// Forgets all changes.
    fn forget(&mut self) {
        for cell in self.touched.drain(..) {
            self.slot[cell as usize % CHUNK] = UNTOUCHED;
        }
    }

    /// The cells whose rings have changed, in rising order once all is concluded.
    pub fn touched(&self) -> &[u32] {
        &self.touched
    }

    /// By how many half-edges there are more than before.
    pub fn growth(&self) -> i32 {
        self.growth
    }

    #[inline]
    fn ring(&self, cell: usize) -> Option<&[Site]> {
        match self.slot[cell % CHUNK] {
            UNTOUCHED => None,
            slot => Some(&self.rings[slot as usize]),
        }
    }

    fn touch(&mut self, tessellation: &Tessellation, cell: u32) -> &mut Ring {
        let slot = &mut self.slot[cell as usize % CHUNK];
        if *slot == UNTOUCHED {
            let next = self.touched.len();
            *slot = next as u32;
            self.touched.push(cell);
            if self.rings.len() == next {
                self.rings.push(Ring::new());
            }
            let ring = tessellation.ring(cell as usize);
            let neighbours = tessellation.neighbour[ring.clone()].iter().copied();
            self.rings[next].clear();
            self.rings[next].extend(neighbours.zip(tessellation.image[ring].iter().copied()));
        }
        &mut self.rings[*slot as usize]
    }
}

impl Reach<'_> {
    /// Flips until no edge of a queue is left that may not be a Delaunay edge, but for those `left` that reach beyond.
    fn flip_all(
        &mut self,
        positions: &[Vector<f64>],
        queue: &mut Vec<Edge>,
        left: &mut Vec<Edge>,
    ) -> Result<usize, Tangled> {
        let cells: usize = self.parts.iter().map(|part| part.slot.len()).sum();
        let most = FLIPS_PER_CELL * cells.max(20);
        let mut flips = 0;
        while let Some(edge) = queue.pop() {
            let Some([before, after]) = self.opposite(edge) else {
                continue; // flipped away
            };
            let sites = [(edge.from, [0, 0]), before, edge.to, after];
            let decided = is_delaunay(positions, &self.tessellation.domain(), sites);
            if decided == Some(true) {
                continue;
            }
            if decided.is_some() && !sites.iter().all(|site| self.holds(site.0)) {
                left.push(edge);
                continue;
            }
            flips += 1;
            if decided.is_none() || flips > most || !self.flip(sites, queue) {
                return Err(Tangled);
            }
        }
        Ok(flips)
    }

    fn holds(&self, cell: u32) -> bool {
        (self.first..self.first + self.parts.len()).contains(&(cell as usize / CHUNK))
    }

    fn part(&mut self, cell: u32) -> &mut Part {
        &mut self.parts[cell as usize / CHUNK - self.first]
    }

    /// The sites before and after an edge in the ring of its first cell; none of an edge of the hull.
    fn opposite(&self, edge: Edge) -> Option<[Site; 2]> {
        let (tessellation, cell) = (self.tessellation, edge.from as usize);
        let is_closed = tessellation.is_closed(cell);
        let around = |sides: usize, site: &dyn Fn(usize) -> Site| {
            let m = (0..sides).find(|&m| site(m) == edge.to)?;
            if !is_closed && (m == 0 || m + 1 == sides) {
                return None;
            }
            Some([site(if m == 0 { sides - 1 } else { m - 1 }), site(if m + 1 == sides { 0 } else { m + 1 })])
        };
        match self.parts[cell / CHUNK - self.first].ring(cell) {
            Some(ring) => around(ring.len(), &|m| ring[m]),
            None => {
                let ring = tessellation.ring(cell);
                around(ring.len(), &|m| {
                    (tessellation.neighbour[ring.start + m], tessellation.image[ring.start + m])
                })
            }
        }
    }

    fn flip(&mut self, sites: [Site; 4], queue: &mut Vec<Edge>) -> bool {
        let seen = |from: usize, to: usize| {
            let ((_, origin), (cell, image)) = (sites[from], sites[to]);
            (cell, [image[0] - origin[0], image[1] - origin[1]])
        };
        let tessellation = self.tessellation;
        let mut sound = true;
        for (end, other) in [(0, 2), (2, 0)] {
            let ring = self.part(sites[end].0).touch(tessellation, sites[end].0);
            let site = seen(end, other);
            let place = ring.iter().position(|s| *s == site);
            sound &= place.map(|m| ring.remove(m)).is_some();
        }
        // Seen from the second site, the quadrilateral opens from the third to the first; from the fourth, the other way.
        for (end, other, next) in [(1, 3, 0), (3, 1, 2)] {
            let ring = self.part(sites[end].0).touch(tessellation, sites[end].0);
            let following = seen(end, next);
            let place = ring.iter().position(|s| *s == following);
            sound &= place.map(|m| ring.insert(m, seen(end, other))).is_some();
        }
        for (from, to) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
            queue.push(Edge { from: sites[from].0, to: seen(from, to) });
        }
        sound
    }
}
