//! The topology of a Voronoi tessellation: who is whose neighbour, across which image.

use crate::{Domain, Scalar, Vector};
use rayon::prelude::*;

/// Which cells are neighbours, as flat arrays over *half-edges*.
///
/// Half-edge `h` belongs to one cell and points at one neighbour (a side of the cell's polygon). The half-edges of a
/// cell are consecutive and in counter-clockwise order: its *ring*. A cell may be its own neighbour, or meet one
/// neighbour several times, in a small periodic box; half-edges keep such meetings apart by their image.
#[derive(Debug, Clone, PartialEq)]
pub struct Tessellation {
    pub(crate) domain: Domain,
    /// First half-edge of each cell, and the number of half-edges at the end.
    pub(crate) start: Vec<u32>,
    pub(crate) neighbour: Vec<u32>,
    pub(crate) image: Vec<[i16; 2]>,
    /// Where in the ring of the neighbour it points back: no number of a half-edge, so that it stays when others move.
    pub(crate) twin_place: Vec<u32>,
    /// Cells whose ring does not close: those on the convex hull of an open field.
    pub(crate) on_hull: Vec<bool>,
}

/// A Delaunay triangle; its circumcentre is a Voronoi vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    /// The three cells, counter-clockwise.
    pub cells: [u32; 3],
    /// Image of each cell relative to the first (which is `[0, 0]`).
    pub images: [[i16; 2]; 3],
}

impl Tessellation {
    /// Number of cells that any tessellation can hold: half-edges are numbered by 32 bits.
    pub const CELL_LIMIT: usize = (u32::MAX / 8) as usize;

    /// The boundary condition.
    pub fn domain(&self) -> Domain {
        self.domain
    }

    pub(crate) fn set_domain(&mut self, domain: Domain) {
        self.domain = domain;
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.start.len() - 1
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of half-edges: about six per cell.
    pub fn half_edges(&self) -> usize {
        self.neighbour.len()
    }

    /// The first half-edge of a cell; for a cell number of N, the number of half-edges.
    #[inline]
    pub fn half_edge_start(&self, cell: usize) -> usize {
        self.start[cell] as usize
    }

    /// The half-edges of a cell, counter-clockwise.
    #[inline]
    pub fn ring(&self, cell: usize) -> std::ops::Range<usize> {
        self.start[cell] as usize..self.start[cell + 1] as usize
    }

    /// The half-edges clockwise and counter-clockwise of one of a cell. `None` past the end of an open ring.
    pub(crate) fn beside(&self, cell: usize, h: usize) -> Option<[usize; 2]> {
        let ring = self.ring(cell);
        let around = |at: usize| self.is_closed(cell).then_some(at);
        let before = if h == ring.start { around(ring.end - 1)? } else { h - 1 };
        let after = if h + 1 == ring.end { around(ring.start)? } else { h + 1 };
        Some([before, after])
    }

    /// The cell that half-edge `h` points at.
    #[inline]
    pub fn neighbour(&self, h: usize) -> usize {
        self.neighbour[h] as usize
    }

    /// The neighbours of a cell, counter-clockwise, one for each side of its polygon.
    #[inline]
    pub fn neighbours(&self, cell: usize) -> &[u32] {
        &self.neighbour[self.ring(cell)]
    }

    /// Lattice vectors from the neighbour as given to the image that is met.
    #[inline]
    pub fn image(&self, h: usize) -> [i16; 2] {
        self.image[h]
    }

    /// The same side seen from the other cell.
    #[inline]
    pub fn twin(&self, h: usize) -> usize {
        self.start[self.neighbour[h] as usize] as usize + self.twin_place[h] as usize
    }

    /// The sides of a cell seen from the other cells, in the order of its ring.
    #[inline]
    pub fn twins(&self, cell: usize) -> impl ExactSizeIterator<Item = usize> {
        let ring = self.ring(cell);
        let pairs = self.neighbour[ring.clone()].iter().zip(&self.twin_place[ring]);
        pairs.map(|(&other, &place)| self.start[other as usize] as usize + place as usize)
    }

    /// The place of the same side in the ring of the other cell.
    #[inline]
    pub fn twin_place(&self, h: usize) -> usize {
        self.twin_place[h] as usize
    }

    /// Whether the polygon of a cell is closed.
    #[inline]
    pub fn is_closed(&self, cell: usize) -> bool {
        !self.on_hull[cell]
    }

    /// Displacement from `cell` to the neighbour that its half-edge `h` points at.
    #[inline]
    pub fn displacement<S: Scalar>(&self, positions: &[Vector<S>], cell: usize, h: usize) -> Vector<S> {
        self.domain.displacement(positions[cell], positions[self.neighbour(h)], self.image[h])
    }

    /// Displacements from `cell` to its neighbours, in the order of its ring.
    #[inline]
    pub fn displacements<S: Scalar>(
        &self,
        positions: &[Vector<S>],
        cell: usize,
    ) -> impl ExactSizeIterator<Item = Vector<S>> {
        let (ring, domain, from) = (self.ring(cell), self.domain, positions[cell]);
        (self.neighbour[ring.clone()].iter().zip(&self.image[ring]))
            .map(move |(&to, &image)| domain.displacement(from, positions[to as usize], image))
    }

    /// The Delaunay triangles (Voronoi vertices), each once. Two per cell in a periodic box.
    pub fn triangles(&self) -> Vec<Triangle> {
        (0..self.len())
            .into_par_iter()
            .flat_map_iter(|cell| {
                let ring = self.ring(cell);
                let sides = ring.len();
                let corners = if self.is_closed(cell) { sides } else { sides.saturating_sub(1) };
                (0..corners).filter_map(move |m| {
                    let (a, b) = (ring.start + m, ring.start + (m + 1) % sides);
                    // The triangle is reached from each of its corners; the lowest half-edge speaks for it.
                    let second = self.next_corner(b);
                    let third = self.next_corner(self.next_in_ring(self.neighbour(b), second));
                    (a < second && a < third).then(|| Triangle {
                        cells: [cell as u32, self.neighbour[a], self.neighbour[b]],
                        images: [[0, 0], self.image[a], self.image[b]],
                    })
                })
            })
            .collect()
    }

    /// From the second half-edge of a triangle's corner to the first half-edge of its next corner (clockwise).
    fn next_corner(&self, h: usize) -> usize {
        self.twin(h)
    }

    /// From the side of a triangle that half-edge `h` is, the triangle to its left, to the next one counter-clockwise.
    /// Outside a convex hull, the same of what is outside.
    pub(crate) fn next_around_triangle(&self, h: usize) -> usize {
        let (back, ring) = (self.twin(h), self.ring(self.neighbour(h)));
        if back == ring.start { ring.end - 1 } else { back - 1 }
    }

    fn next_in_ring(&self, cell: usize, h: usize) -> usize {
        let ring = self.ring(cell);
        if h + 1 == ring.end { ring.start } else { h + 1 }
    }

    /// The Delaunay edges as sorted, directed pairs with their image: what changes in a T1 transition.
    ///
    /// Each edge appears once, from the lower to the higher cell.
    pub fn edges(&self) -> Vec<(u32, u32, [i16; 2])> {
        let mut edges: Vec<_> = (0..self.len())
            .flat_map(|cell| self.ring(cell).map(move |h| (cell, h)))
            .filter(|&(_, h)| h < self.twin(h))
            .map(|(cell, h)| {
                let (from, to, image) = (cell as u32, self.neighbour[h], self.image[h]);
                if from <= to { (from, to, image) } else { (to, from, [-image[0], -image[1]]) }
            })
            .collect();
        edges.sort_unstable();
        edges
    }
}
