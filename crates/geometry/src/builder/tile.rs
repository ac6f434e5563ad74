//! A periodic box cut into tiles, each triangulated with its surroundings.

use super::mesh::Mesh;
use super::rectangle::Rectangle;
use super::rings::Rings;
use super::site::{Role, Site};
use crate::{PeriodicBox, Vector};

/// Cells per tile: large enough that the strip around it is a small part, small enough for the caches.
const CELLS_PER_TILE: f64 = 1000.0;

/// First width of the strip around a tile, in units of √(area per cell). The circumcircles of a tissue fit, and nearly all of random points; where
/// one does not, the strip of that tile is widened until it does, and all of the tile is triangulated again.
const STRIP: f64 = 2.0;

/// Wrapped cells, sorted into bins, and the grid of tiles over them.
pub(super) struct Tiling<'a> {
    wrapped: &'a [Vector<f64>],
    cell_box: &'a PeriodicBox,
    spacing: f64,
    tiles: [usize; 2],
    bins: [usize; 2],
    bin_start: Vec<u32>,
    binned: Vec<u32>,
}

impl<'a> Tiling<'a> {
    pub fn new(wrapped: &'a [Vector<f64>], cell_box: &'a PeriodicBox) -> Self {
        let spacing = (cell_box.area() / wrapped.len() as f64).sqrt();
        let along = |size: f64| {
            cell_box.lengths().map(|l| ((l / (size * spacing)).round() as usize).clamp(1, 1 << 15))
        };
        let tiles = along(CELLS_PER_TILE.sqrt());
        // Half as wide as the strip, so that little is gathered in vain.
        let bins = along(STRIP / 2.0);
        let mut tiling = Self {
            wrapped,
            cell_box,
            spacing,
            tiles,
            bins,
            bin_start: vec![0; bins[0] * bins[1] + 1],
            binned: vec![0; wrapped.len()],
        };
        let bin_of: Vec<u32> = wrapped.iter().map(|r| tiling.bin_at(*r) as u32).collect();
        for &bin in &bin_of {
            tiling.bin_start[bin as usize + 1] += 1;
        }
        for bin in 1..tiling.bin_start.len() {
            tiling.bin_start[bin] += tiling.bin_start[bin - 1];
        }
        let mut next = tiling.bin_start.clone();
        for (cell, &bin) in bin_of.iter().enumerate() {
            let at = &mut next[bin as usize];
            tiling.binned[*at as usize] = cell as u32;
            *at += 1;
        }
        tiling
    }

    pub fn len(&self) -> usize {
        self.tiles[0] * self.tiles[1]
    }

    /// The rings of a tile's own cells, or nothing if two sites coincide.
    pub fn rings<M: Mesh>(&self, tile: usize) -> Option<Rings> {
        let region = self.region(tile);
        let mut strip = STRIP * self.spacing;
        loop {
            let surroundings = region.grown(strip);
            let (points, sites) = self.gather(&region, &surroundings);
            if let Some(rings) = Rings::of_own(&M::of(&points)?, &points, &sites, &surroundings) {
                return Some(rings);
            }
            strip *= 1.5;
        }
    }

    fn region(&self, tile: usize) -> Rectangle {
        let at = [tile % self.tiles[0], tile / self.tiles[0]];
        let lengths = self.cell_box.lengths();
        // Rounding may put a wrapped coordinate onto the upper end of the box: the last tile takes it in.
        let edge = |axis: usize, k: usize| match k {
            k if k == self.tiles[axis] => lengths[axis] * (1.0 + 1e-6),
            0 => -lengths[axis] * 1e-6,
            k => lengths[axis] * k as f64 / self.tiles[axis] as f64,
        };
        Rectangle { low: [edge(0, at[0]), edge(1, at[1])], high: [edge(0, at[0] + 1), edge(1, at[1] + 1)] }
    }

    fn bin_at(&self, r: Vector<f64>) -> usize {
        let index = |axis: usize| self.bin_along(axis, r[axis]);
        index(1) * self.bins[0] + index(0)
    }

    fn bin_along(&self, axis: usize, x: f64) -> usize {
        let bins = self.bins[axis];
        ((x / self.cell_box.lengths()[axis] * bins as f64).max(0.0) as usize).min(bins - 1)
    }

    /// All cells and images within the surroundings; those of the tile itself are its own.
    fn gather(&self, region: &Rectangle, surroundings: &Rectangle) -> (Vec<Vector<f64>>, Vec<Site>) {
        let lengths = self.cell_box.lengths();
        let expected = (surroundings.high[0] - surroundings.low[0])
            * (surroundings.high[1] - surroundings.low[1])
            / (self.spacing * self.spacing);
        let expected = (expected * 1.1) as usize + 16;
        let (mut points, mut sites) = (Vec::with_capacity(expected), Vec::with_capacity(expected));
        // Images whose box overlaps the surroundings.
        let overlap = |axis: usize, shift: f64| {
            let first = ((surroundings.low[axis] - shift) / lengths[axis] - 1e-6).floor() as i32;
            let last = ((surroundings.high[axis] - shift) / lengths[axis] + 1e-6).floor() as i32;
            first..=last
        };
        for row in overlap(1, 0.0) {
            for column in overlap(0, f64::from(row) * self.cell_box.offset()) {
                let shift = self.cell_box.translation([column, row]);
                // One bin more on each side, against rounding at the edges of bins.
                let span = |axis: usize| {
                    let low = self.bin_along(axis, surroundings.low[axis] - shift[axis]).saturating_sub(1);
                    let high = self.bin_along(axis, surroundings.high[axis] - shift[axis]) + 1;
                    (low, high.min(self.bins[axis] - 1))
                };
                let ((x0, x1), (y0, y1)) = (span(0), span(1));
                for y in y0..=y1 {
                    let line = y * self.bins[0];
                    let begin = self.bin_start[line + x0] as usize;
                    let end = self.bin_start[line + x1 + 1] as usize;
                    for &cell in &self.binned[begin..end] {
                        let r = self.wrapped[cell as usize] + shift;
                        if surroundings.contains(r) {
                            let own = (row, column) == (0, 0) && region.contains(r);
                            points.push(r);
                            sites.push(Site {
                                cell,
                                image: [column as i16, row as i16],
                                role: if own { Role::Own } else { Role::Ghost },
                            });
                        }
                    }
                }
            }
        }
        (points, sites)
    }
}
