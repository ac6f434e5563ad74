//! Changed rings are put into the flat arrays.

use super::diagonal::Site;
use super::lawson::{Lawson, Part};
use super::split::{CHUNK, by_cells};
use crate::Tessellation;
use rayon::prelude::*;
use std::ops::Range;

/// A second set of arrays: what is read and what is written change places.
#[derive(Debug, Clone, Default)]
pub(super) struct Spare {
    start: Vec<u32>,
    neighbour: Vec<u32>,
    image: Vec<[i16; 2]>,
    twin_place: Vec<u32>,
    /// Whether the ring of a neighbour has changed, of each cell.
    beside: Vec<bool>,
}

/// The arrays over some cells and their half-edges, from the first of them on.
struct Stretch<'a> {
    start: &'a mut [u32],
    neighbour: &'a mut [u32],
    image: &'a mut [[i16; 2]],
    twin_place: &'a mut [u32],
    beside: &'a mut [bool],
}

impl Spare {
    /// Replaces the rings of a tessellation that flips have changed.
    pub fn splice(&mut self, tessellation: &mut Tessellation, changes: &Lawson) {
        let cells = tessellation.len();
        self.beside.resize(cells, false);
        let mut any = false;
        for cell in changes.parts().iter().flat_map(Part::touched) {
            any = true;
            for (other, _) in changes.ring(*cell as usize).unwrap_or_default() {
                self.beside[*other as usize] = true;
            }
        }
        if !any {
            return;
        }
        self.begin_chunks(tessellation, changes);
        let half_edges = self.start[cells] as usize;
        self.neighbour.resize(half_edges, 0);
        self.image.resize(half_edges, [0, 0]);
        self.twin_place.resize(half_edges, 0);
        let Self { start, neighbour, image, twin_place, beside } = self;
        let move_over = MoveOver { old: tessellation, changes };
        let of_chunks = by_cells(neighbour, start)
            .into_par_iter()
            .zip(by_cells(image, start))
            .zip(by_cells(twin_place, start));
        of_chunks
            .zip(start[..cells].par_chunks_mut(CHUNK))
            .zip(beside.par_chunks_mut(CHUNK))
            .enumerate()
            .for_each(|(chunk, ((((neighbour, image), twin_place), start), beside))| {
                let cells = chunk * CHUNK..chunk * CHUNK + start.len();
                let changed = changes.parts()[chunk].touched();
                let mut to = Stretch { start, neighbour, image, twin_place, beside };
                move_over.cells(cells.clone(), changed, &mut to);
                move_over.point_back(cells, &mut to);
            });
        std::mem::swap(&mut tessellation.start, &mut self.start);
        std::mem::swap(&mut tessellation.neighbour, &mut self.neighbour);
        std::mem::swap(&mut tessellation.image, &mut self.image);
        std::mem::swap(&mut tessellation.twin_place, &mut self.twin_place);
    }

    /// The new beginnings of the first ring of each chunk, and their end.
    fn begin_chunks(&mut self, tessellation: &Tessellation, changes: &Lawson) {
        let cells = tessellation.len();
        self.start.resize(cells + 1, 0);
        let growth = changes.parts().iter().map(Part::growth).chain([0]);
        let mut by = 0;
        for (first, growth) in (0..cells).step_by(CHUNK).chain([cells]).zip(growth) {
            self.start[first] = tessellation.start[first].wrapping_add_signed(by);
            by += growth;
        }
    }
}

/// From the old arrays to the new ones.
struct MoveOver<'a> {
    old: &'a Tessellation,
    changes: &'a Lawson,
}

impl MoveOver<'_> {
    /// Writes the rings of some cells, given those among them that have changed, but for where changed rings are pointed back from.
    fn cells(&self, cells: Range<usize>, changed: &[u32], to: &mut Stretch<'_>) {
        let offset = to.start[0];
        let (mut first, mut next) = (cells.start, 0);
        for cell in changed.iter().map(|cell| *cell as usize).chain([cells.end]) {
            let from = self.old.start[first] as usize..self.old.start[cell] as usize;
            let own = next..next + from.len();
            to.neighbour[own.clone()].copy_from_slice(&self.old.neighbour[from.clone()]);
            to.image[own.clone()].copy_from_slice(&self.old.image[from.clone()]);
            to.twin_place[own.clone()].copy_from_slice(&self.old.twin_place[from.clone()]);
            let by = (offset + next as u32).wrapping_sub(from.start as u32);
            let starts = &mut to.start[first - cells.start..cell - cells.start];
            for (new, old) in starts.iter_mut().zip(&self.old.start[first..cell]) {
                *new = old.wrapping_add(by);
            }
            next = own.end;
            if cell == cells.end {
                break;
            }
            to.start[cell - cells.start] = offset + next as u32;
            for &(other, image) in self.changes.ring(cell).unwrap_or_default() {
                (to.neighbour[next], to.image[next]) = (other, image);
                next += 1;
            }
            to.beside[cell - cells.start] = true;
            first = cell + 1;
        }
    }

    /// Finds where the twins are that changed rings have, or that are pointed at from these.
    fn point_back(&self, cells: Range<usize>, to: &mut Stretch<'_>) {
        let offset = to.start[0];
        for (own, cell) in cells.enumerate().filter(|(own, _)| to.beside[*own]) {
            let begin = (to.start[own] - offset) as usize;
            let end = to.start.get(own + 1).map_or(to.neighbour.len(), |next| (next - offset) as usize);
            let has_changed = self.changes.ring(cell).is_some();
            for h in begin..end {
                let (other, [x, y]) = (to.neighbour[h] as usize, to.image[h]);
                let back: Site = (cell as u32, [-x, -y]);
                let place = match self.changes.ring(other) {
                    Some(ring) => ring.iter().position(|site| *site == back),
                    None if has_changed => {
                        let old = self.old;
                        old.ring(other).position(|h| (old.neighbour[h], old.image[h]) == back)
                    }
                    None => continue,
                };
                // Every flip changes both ends of an edge, so the place is there.
                to.twin_place[h] = place.unwrap_or_default() as u32;
            }
        }
        to.beside.fill(false);
    }
}
