//! Changed rings are put into the flat arrays.

use super::diagonal::Site;
use super::lawson::Lawson;
use super::split::{CHUNK, by_cells};
use crate::Tessellation;
use rayon::prelude::*;
use std::ops::Range;

/// The shift of a cell whose ring has changed: its half-edges have to be looked for.
const CHANGED: i32 = i32::MIN;

/// A second set of arrays: what is read and what is written change places.
#[derive(Debug, Clone, Default)]
pub(super) struct Spare {
    start: Vec<u32>,
    neighbour: Vec<u32>,
    image: Vec<[i16; 2]>,
    twin: Vec<u32>,
    /// How far the half-edges of a cell move.
    shift: Vec<i32>,
    /// The cells whose rings have changed, in rising order: all is copied in runs between them.
    changed: Vec<u32>,
}

/// The arrays over the half-edges of some cells, from the first of them on.
struct Stretch<'a> {
    neighbour: &'a mut [u32],
    image: &'a mut [[i16; 2]],
    twin: &'a mut [u32],
}

impl Spare {
    /// Replaces the rings of a tessellation that flips have changed.
    pub fn splice(&mut self, tessellation: &mut Tessellation, changes: &Lawson) {
        if changes.touched().is_empty() {
            return;
        }
        self.changed.clear();
        self.changed.extend_from_slice(changes.touched());
        self.changed.sort_unstable();
        self.renumber(tessellation, changes);
        let cells = tessellation.len();
        let half_edges = self.start[cells] as usize;
        self.neighbour.resize(half_edges, 0);
        self.image.resize(half_edges, [0, 0]);
        self.twin.resize(half_edges, 0);
        let Self { start, neighbour, image, twin, shift, changed } = self;
        let move_over = MoveOver { old: tessellation, changes, start, shift };
        by_cells(neighbour, start)
            .into_par_iter()
            .zip(by_cells(image, start))
            .zip(by_cells(twin, start))
            .enumerate()
            .for_each(|(chunk, ((neighbour, image), twin))| {
                let cells = chunk * CHUNK..((chunk + 1) * CHUNK).min(cells);
                let place = |cell: usize| changed.partition_point(|&c| (c as usize) < cell);
                let changed = &changed[place(cells.start)..place(cells.end)];
                move_over.cells(cells, changed, Stretch { neighbour, image, twin });
            });
        std::mem::swap(&mut tessellation.start, &mut self.start);
        std::mem::swap(&mut tessellation.neighbour, &mut self.neighbour);
        std::mem::swap(&mut tessellation.image, &mut self.image);
        std::mem::swap(&mut tessellation.twin, &mut self.twin);
    }

    /// The new beginnings of the rings.
    fn renumber(&mut self, tessellation: &Tessellation, changes: &Lawson) {
        let old = tessellation.start.as_slice();
        let cells = tessellation.len();
        self.start.resize(cells + 1, 0);
        self.shift.resize(cells, 0);
        let (mut first, mut by) = (0, 0);
        for cell in self.changed.iter().map(|&cell| cell as usize).chain([cells]) {
            for (new, old) in self.start[first..=cell].iter_mut().zip(&old[first..]) {
                *new = old.wrapping_add_signed(by);
            }
            self.shift[first..cell].fill(by);
            if let Some(ring) = (cell < cells).then(|| changes.ring(cell)).flatten() {
                self.shift[cell] = CHANGED;
                by += ring.len() as i32 - tessellation.ring(cell).len() as i32;
            }
            first = cell + 1;
        }
    }
}

/// From the old arrays to the new ones.
struct MoveOver<'a> {
    old: &'a Tessellation,
    changes: &'a Lawson,
    start: &'a [u32],
    shift: &'a [i32],
}

impl MoveOver<'_> {
    /// Writes the rings of some cells, given those among them that have changed.
    fn cells(&self, cells: Range<usize>, changed: &[u32], mut to: Stretch<'_>) {
        let offset = self.start[cells.start] as usize;
        let mut first = cells.start;
        for &cell in changed {
            let cell = cell as usize;
            self.unchanged(first..cell, offset, &mut to);
            self.changed(cell, offset, &mut to);
            first = cell + 1;
        }
        self.unchanged(first..cells.end, offset, &mut to);
    }

    fn unchanged(&self, cells: Range<usize>, offset: usize, to: &mut Stretch<'_>) {
        if cells.is_empty() {
            return;
        }
        let from = self.old.start[cells.start] as usize..self.old.start[cells.end] as usize;
        let own = self.start[cells.start] as usize - offset..self.start[cells.end] as usize - offset;
        to.neighbour[own.clone()].copy_from_slice(&self.old.neighbour[from.clone()]);
        to.image[own.clone()].copy_from_slice(&self.old.image[from.clone()]);
        let old = self.old.neighbour[from.clone()].iter().zip(&self.old.twin[from]);
        for (twin, (&other, &before)) in to.twin[own].iter_mut().zip(old) {
            *twin = match self.shift[other as usize] {
                CHANGED => {
                    let back = before as usize;
                    self.half_edge(other, (self.old.neighbour[back], self.old.image[back]))
                }
                by => before.wrapping_add_signed(by),
            };
        }
    }

    fn changed(&self, cell: usize, offset: usize, to: &mut Stretch<'_>) {
        let own = self.start[cell] as usize - offset..self.start[cell + 1] as usize - offset;
        for (h, &(other, [x, y])) in own.zip(self.changes.ring(cell).unwrap_or_default()) {
            to.neighbour[h] = other;
            to.image[h] = [x, y];
            to.twin[h] = self.half_edge(other, (cell as u32, [-x, -y]));
        }
    }

    /// The new number of the half-edge from a cell to a site.
    fn half_edge(&self, from: u32, to: Site) -> u32 {
        let cell = from as usize;
        let place = match self.changes.ring(cell) {
            Some(ring) => ring.iter().position(|site| *site == to),
            None => {
                let old = self.old;
                old.ring(cell).position(|h| (old.neighbour[h], old.image[h]) == to)
            }
        };
        // Every flip changes both ends of an edge, so the place is there.
        self.start[cell] + place.unwrap_or_default() as u32
    }
}
