//! Lawson's flips: edges that are not Delaunay edges are exchanged for the other diagonal until none is left.

use super::diagonal::{Site, is_delaunay};
use super::scan::Edge;
use crate::{Tessellation, Vector};

/// A cell that no flip has touched.
const UNTOUCHED: u32 = u32::MAX;

/// Flips per cell after which a triangulation is given up: a disordered one needs about one.
const FLIPS_PER_CELL: usize = 50;

/// The flips did not come to an end: rounding, or triangles that were turned over, or cells on a circle in an open field.
pub(super) struct Tangled;

/// The rings that flips have changed, apart from the arrays of the tessellation. Memory is kept from call to call.
#[derive(Debug, Clone, Default)]
pub(super) struct Lawson {
    /// For each cell, its place in `rings`.
    slot: Vec<u32>,
    /// The cells touched, in the order of their rings.
    touched: Vec<u32>,
    rings: Vec<Vec<Site>>,
    pub(super) queue: Vec<Edge>,
}

impl Lawson {
    /// Flips until every edge is a Delaunay edge, given the edges that may not be. Returns the number of flips.
    pub fn settle(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        suspects: &[Edge],
    ) -> Result<usize, Tangled> {
        self.begin(tessellation.len());
        self.queue.extend(suspects.iter().rev());
        let flips = self.flip_all(tessellation, positions)?;
        self.begin_at_lowest(tessellation);
        Ok(flips)
    }

    /// Forgets all changes, of so many cells from now on.
    pub fn begin(&mut self, cells: usize) {
        self.forget();
        self.slot.resize(cells, UNTOUCHED);
        self.queue.clear();
    }

    /// Flips until no edge is left that may not be a Delaunay edge.
    pub fn flip_all(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
    ) -> Result<usize, Tangled> {
        let most = FLIPS_PER_CELL * tessellation.len().max(20);
        let mut flips = 0;
        while let Some(edge) = self.queue.pop() {
            let Some([before, after]) = self.opposite(tessellation, edge) else {
                continue; // flipped away
            };
            let own = (edge.from, [0, 0]);
            let decided = is_delaunay(positions, &tessellation.domain(), [own, before, edge.to, after]);
            if decided == Some(true) {
                continue;
            }
            flips += 1;
            if decided.is_none() || flips > most || !self.flip(tessellation, [own, before, edge.to, after]) {
                self.forget();
                return Err(Tangled);
            }
        }
        Ok(flips)
    }

    /// Lets the rings that have changed begin as those of a tessellation do.
    pub fn begin_at_lowest(&mut self, tessellation: &Tessellation) {
        for &cell in &self.touched {
            let ring = &mut self.rings[self.slot[cell as usize] as usize];
            if !tessellation.is_closed(cell as usize) {
                continue;
            }
            let lowest = (0..ring.len()).min_by_key(|&m| ring[m]).unwrap_or(0);
            ring.rotate_left(lowest);
        }
    }

    /// The cells whose rings have changed.
    pub fn touched(&self) -> &[u32] {
        &self.touched
    }

    /// The new ring of a cell, from its lowest neighbour on or along the hull, if flips have changed it.
    #[inline]
    pub fn ring(&self, cell: usize) -> Option<&[Site]> {
        match self.slot[cell] {
            UNTOUCHED => None,
            slot => Some(&self.rings[slot as usize]),
        }
    }

    /// Forgets all changes.
    pub fn forget(&mut self) {
        for cell in self.touched.drain(..) {
            self.slot[cell as usize] = UNTOUCHED;
        }
    }

    /// The sites before and after an edge in the ring of its first cell; none of an edge of the hull.
    fn opposite(&self, tessellation: &Tessellation, edge: Edge) -> Option<[Site; 2]> {
        let is_closed = tessellation.is_closed(edge.from as usize);
        let around = |sides: usize, site: &dyn Fn(usize) -> Site| {
            let m = (0..sides).find(|&m| site(m) == edge.to)?;
            if !is_closed && (m == 0 || m + 1 == sides) {
                return None;
            }
            Some([site(if m == 0 { sides - 1 } else { m - 1 }), site(if m + 1 == sides { 0 } else { m + 1 })])
        };
        let cell = edge.from as usize;
        match self.ring(cell) {
            Some(ring) => around(ring.len(), &|m| ring[m]),
            None => {
                let ring = tessellation.ring(cell);
                around(ring.len(), &|m| {
                    (tessellation.neighbour[ring.start + m], tessellation.image[ring.start + m])
                })
            }
        }
    }

    /// Exchanges the diagonal between the first and the third of four counter-clockwise sites for the other. False if the
    /// rings are not those of a triangulation.
    pub(super) fn flip(&mut self, tessellation: &Tessellation, sites: [Site; 4]) -> bool {
        let seen = |from: usize, to: usize| {
            let ((_, origin), (cell, image)) = (sites[from], sites[to]);
            (cell, [image[0] - origin[0], image[1] - origin[1]])
        };
        let mut sound = true;
        for (end, other) in [(0, 2), (2, 0)] {
            let ring = self.touch(tessellation, sites[end].0);
            let site = seen(end, other);
            let place = ring.iter().position(|s| *s == site);
            sound &= place.map(|m| ring.remove(m)).is_some();
        }
        // Seen from the second site, the quadrilateral opens from the third to the first; from the fourth, the other way.
        for (end, other, next) in [(1, 3, 0), (3, 1, 2)] {
            let ring = self.touch(tessellation, sites[end].0);
            let following = seen(end, next);
            let place = ring.iter().position(|s| *s == following);
            sound &= place.map(|m| ring.insert(m, seen(end, other))).is_some();
        }
        for (from, to) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
            self.queue.push(Edge { from: sites[from].0, to: seen(from, to) });
        }
        sound
    }

    pub(super) fn touch(&mut self, tessellation: &Tessellation, cell: u32) -> &mut Vec<Site> {
        let slot = &mut self.slot[cell as usize];
        if *slot == UNTOUCHED {
            let next = self.touched.len();
            *slot = next as u32;
            self.touched.push(cell);
            if self.rings.len() == next {
                self.rings.push(Vec::new());
            }
            let ring = tessellation.ring(cell as usize);
            let neighbours = tessellation.neighbour[ring.clone()].iter().copied();
            self.rings[next].clear();
            self.rings[next].extend(neighbours.zip(tessellation.image[ring].iter().copied()));
        }
        &mut self.rings[*slot as usize]
    }
}
