//! Changed rings are put into the flat arrays.

use super::lawson::Lawson;
use super::split::{CHUNK, by_cells};
use crate::Tessellation;
use rayon::prelude::*;

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
}

impl Spare {
    /// Replaces the rings of a tessellation that flips have changed.
    pub fn splice(&mut self, tessellation: &mut Tessellation, changes: &Lawson) {
        if changes.touched().is_empty() {
            return;
        }
        let cells = tessellation.len();
        self.renumber(tessellation, changes);
        let half_edges = self.start[cells] as usize;
        self.neighbour.resize(half_edges, 0);
        self.image.resize(half_edges, [0, 0]);
        self.twin.resize(half_edges, 0);
        let Self { start, neighbour, image, twin, shift } = self;
        let (start, shift) = (start.as_slice(), shift.as_slice());
        let old = &*tessellation;
        by_cells(neighbour, start)
            .into_par_iter()
            .zip(by_cells(image, start))
            .zip(by_cells(twin, start))
            .enumerate()
            .for_each(|(chunk, ((neighbour, image), twin))| {
                let first = chunk * CHUNK;
                for cell in first..(first + CHUNK).min(cells) {
                    let own =
                        (start[cell] - start[first]) as usize..(start[cell + 1] - start[first]) as usize;
                    match changes.ring(cell) {
                        Some(ring) => {
                            for (h, &(other, across)) in own.zip(ring) {
                                neighbour[h] = other;
                                image[h] = across;
                                twin[h] = twin_of(old, changes, start, cell, (other, across));
                            }
                        }
                        None => {
                            let ring = old.ring(cell);
                            neighbour[own.clone()].copy_from_slice(&old.neighbour[ring.clone()]);
                            image[own.clone()].copy_from_slice(&old.image[ring.clone()]);
                            for (h, g) in own.zip(ring) {
                                let other = old.neighbour[g];
                                twin[h] = match shift[other as usize] {
                                    CHANGED => twin_of(old, changes, start, cell, (other, old.image[g])),
                                    by => old.twin[g].wrapping_add_signed(by),
                                };
                            }
                        }
                    }
                }
            });
        std::mem::swap(&mut tessellation.start, &mut self.start);
        std::mem::swap(&mut tessellation.neighbour, &mut self.neighbour);
        std::mem::swap(&mut tessellation.image, &mut self.image);
        std::mem::swap(&mut tessellation.twin, &mut self.twin);
    }

    /// The new beginnings of the rings.
    fn renumber(&mut self, tessellation: &Tessellation, changes: &Lawson) {
        let cells = tessellation.len();
        self.start.resize(cells + 1, 0);
        self.shift.resize(cells, 0);
        let mut next = 0;
        for cell in 0..cells {
            let old = tessellation.ring(cell);
            self.start[cell] = next;
            let (shift, sides) = match changes.ring(cell) {
                Some(ring) => (CHANGED, ring.len()),
                None => (next as i32 - old.start as i32, old.len()),
            };
            self.shift[cell] = shift;
            next += sides as u32;
        }
        self.start[cells] = next;
    }
}

/// The new number of the half-edge opposite to the one from `cell` to a site.
fn twin_of(
    old: &Tessellation,
    changes: &Lawson,
    start: &[u32],
    cell: usize,
    (other, [x, y]): (u32, [i16; 2]),
) -> u32 {
    let back = (cell as u32, [-x, -y]);
    let place = match changes.ring(other as usize) {
        Some(ring) => ring.iter().position(|s| *s == back),
        None => old.ring(other as usize).position(|g| (old.neighbour[g], old.image[g]) == back),
    };
    // Every flip changes both ends of an edge, so the place is there.
    start[other as usize] + place.unwrap_or_default() as u32
}
