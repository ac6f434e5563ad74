//! Changed rings are put into the flat arrays, in place.
//!
//! All half-edges behind a changed ring move by a few places. Chunks of cells do so side by side: each takes what it had to a place of its own, of
//! which the ends were saved where chunks beside it move in, and writes it to where it belongs now. So every array passes through memory once.
//! Where sides of unchanged rings point back at changed ones, these write it, or leave word for the chunk of the others.

use super::diagonal::Site;
use super::lawson::Lawson;
use super::split::{CHUNK, into_stretches};
use crate::Tessellation;
use rayon::prelude::*;
use std::ops::Range;

/// The work space, kept from call to call.
#[derive(Debug, Clone, Default)]
pub(super) struct Splice {
    moves: Vec<Move>,
}

/// Where the half-edges of a chunk were and where they come to, and those at either end of the former that are not among the latter.
#[derive(Debug, Clone, Default)]
struct Move {
    from: Range<usize>,
    to: Range<usize>,
    ends: [Sides; 2],
    /// What it has to tell other chunks.
    words: Vec<Word>,
}

/// A side of an unchanged ring, by its cell and its place in the ring, and where its twin is now in the ring of a changed one.
#[derive(Debug, Clone, Copy)]
struct Word {
    cell: u32,
    place: u32,
    twin_place: u32,
}

/// Half-edges in arrays of their own.
#[derive(Debug, Clone, Default)]
struct Sides {
    neighbour: Vec<u32>,
    image: Vec<[i16; 2]>,
    twin_place: Vec<u32>,
}

/// The rings of a chunk as they were.
#[derive(Default)]
struct Before {
    /// First half-edge of each cell, and the end, from that of the first cell on.
    start: Vec<u32>,
    sides: Sides,
}

/// The arrays over the cells of a chunk and over the half-edges that they come to have.
struct Stretch<'a> {
    start: &'a mut [u32],
    neighbour: &'a mut [u32],
    image: &'a mut [[i16; 2]],
    twin_place: &'a mut [u32],
}

impl Splice {
    /// Replaces the rings of a tessellation that flips have changed.
    pub fn splice(&mut self, tessellation: &mut Tessellation, changes: &Lawson) {
        if changes.parts().iter().all(|part| part.touched().is_empty()) {
            return;
        }
        let cells = tessellation.len();
        let half_edges = self.plan(tessellation, changes);
        let Tessellation { start, neighbour, image, twin_place, .. } = tessellation;
        let most = neighbour.len().max(half_edges);
        neighbour.resize(most, 0);
        image.resize(most, [0, 0]);
        twin_place.resize(most, 0);
        self.save_ends(neighbour, image, twin_place);
        start[cells] = half_edges as u32;
        let lengths: Vec<usize> = self.moves.iter().map(|own| own.to.len()).collect();
        let of_chunks = into_stretches(neighbour, &lengths)
            .into_par_iter()
            .zip(into_stretches(image, &lengths))
            .zip(into_stretches(twin_place, &lengths));
        let of_chunks = of_chunks.zip(start[..cells].par_chunks_mut(CHUNK)).zip(&mut self.moves);
        of_chunks.enumerate().for_each_init(
            Before::default,
            |before, (chunk, ((((neighbour, image), twin_place), start), own))| {
                let changed = changes.parts()[chunk].touched();
                own.words.clear();
                if own.from == own.to && changed.is_empty() {
                    return;
                }
                let mut to = Stretch { start, neighbour, image, twin_place };
                before.take(own, &to);
                let chunk = Chunk { first: chunk * CHUNK, begin: own.to.start, before, changes };
                chunk.write(changed, &mut to);
                chunk.point_back(changed, &mut to, &mut own.words);
            },
        );
        for word in self.moves.iter().flat_map(|own| &own.words) {
            twin_place[(start[word.cell as usize] + word.place) as usize] = word.twin_place;
        }
        neighbour.truncate(half_edges);
        image.truncate(half_edges);
        twin_place.truncate(half_edges);
    }

    /// Where the rings of each chunk come to be; the number of half-edges.
    fn plan(&mut self, tessellation: &Tessellation, changes: &Lawson) -> usize {
        let cells = tessellation.len();
        self.moves.resize_with(changes.parts().len(), Move::default);
        let mut begin = 0;
        for (chunk, (own, part)) in self.moves.iter_mut().zip(changes.parts()).enumerate() {
            let [first, last] = [chunk, chunk + 1].map(|chunk| (chunk * CHUNK).min(cells));
            own.from = tessellation.half_edge_start(first)..tessellation.half_edge_start(last);
            own.to = begin..begin + own.from.len().wrapping_add_signed(part.growth() as isize);
            begin = own.to.end;
        }
        begin
    }

    fn save_ends(&mut self, neighbour: &[u32], image: &[[i16; 2]], twin_place: &[u32]) {
        self.moves.par_iter_mut().for_each(|own| {
            let Range { start, end } = own.stays();
            let ranges = [own.from.start..start, end..own.from.end];
            for (saved, range) in own.ends.iter_mut().zip(ranges) {
                saved.clear();
                saved.extend(&neighbour[range.clone()], &image[range.clone()], &twin_place[range]);
            }
        });
    }
}

impl Move {
    /// Those places where the chunk was that it will have again.
    fn stays(&self) -> Range<usize> {
        let Range { start, end } = self.from;
        let first = self.to.start.clamp(start, end);
        first..self.to.end.clamp(first, end)
    }
}

impl Sides {
    fn clear(&mut self) {
        self.neighbour.clear();
        self.image.clear();
        self.twin_place.clear();
    }

    fn extend(&mut self, neighbour: &[u32], image: &[[i16; 2]], twin_place: &[u32]) {
        self.neighbour.extend_from_slice(neighbour);
        self.image.extend_from_slice(image);
        self.twin_place.extend_from_slice(twin_place);
    }
}

impl Before {
    /// Takes what a chunk had from where it is about to be overwritten.
    fn take(&mut self, own: &Move, from: &Stretch<'_>) {
        let first = from.start[0];
        self.start.clear();
        self.start.extend(from.start.iter().map(|start| start - first));
        self.start.push(own.from.len() as u32);
        let stays = own.stays();
        let stays = stays.start.saturating_sub(own.to.start)..stays.end.saturating_sub(own.to.start);
        self.sides.clear();
        let [ahead, behind] = &own.ends;
        self.sides.extend(&ahead.neighbour, &ahead.image, &ahead.twin_place);
        if !stays.is_empty() {
            self.sides.extend(
                &from.neighbour[stays.clone()],
                &from.image[stays.clone()],
                &from.twin_place[stays],
            );
        }
        self.sides.extend(&behind.neighbour, &behind.image, &behind.twin_place);
    }
}

/// A chunk on its way from the old places to the new ones.
struct Chunk<'a> {
    /// Its first cell, and where the half-edges of this begin now.
    first: usize,
    begin: usize,
    before: &'a Before,
    changes: &'a Lawson,
}

impl Chunk<'_> {
    /// Writes all rings, given the cells of which they have changed, but for where changed rings are pointed back from.
    fn write(&self, changed: &[u32], to: &mut Stretch<'_>) {
        let (before, cells) = (self.before, to.start.len());
        let (mut first, mut next) = (0, 0);
        for own in changed.iter().map(|cell| *cell as usize - self.first).chain([cells]) {
            let from = before.start[first] as usize..before.start[own] as usize;
            let at = next..next + from.len();
            to.neighbour[at.clone()].copy_from_slice(&before.sides.neighbour[from.clone()]);
            to.image[at.clone()].copy_from_slice(&before.sides.image[from.clone()]);
            to.twin_place[at.clone()].copy_from_slice(&before.sides.twin_place[from.clone()]);
            let by = ((self.begin + next) as u32).wrapping_sub(from.start as u32);
            for (new, old) in to.start[first..own].iter_mut().zip(&before.start[first..own]) {
                *new = old.wrapping_add(by);
            }
            next = at.end;
            if own == cells {
                break;
            }
            to.start[own] = (self.begin + next) as u32;
            for &(other, image) in self.changes.ring(self.first + own).unwrap_or_default() {
                (to.neighbour[next], to.image[next]) = (other, image);
                next += 1;
            }
            first = own + 1;
        }
    }

    /// Finds where the twins are that changed rings have, and tells those that have not changed.
    fn point_back(&self, changed: &[u32], to: &mut Stretch<'_>, words: &mut Vec<Word>) {
        for &cell in changed {
            let own = cell as usize - self.first;
            let begin = to.start[own] as usize - self.begin;
            let ring = self.changes.ring(cell as usize).unwrap_or_default();
            for (m, &(other, [x, y])) in ring.iter().enumerate() {
                // Every flip changes both ends of an edge, so the place is there.
                let place = match self.changes.ring(other as usize) {
                    Some(ring) => {
                        let back: Site = (cell, [-x, -y]);
                        ring.iter().position(|site| *site == back).unwrap_or_default() as u32
                    }
                    None => {
                        let place = self.place_before(own, (other, [x, y]));
                        let in_chunk = (other as usize).wrapping_sub(self.first);
                        match to.start.get(in_chunk) {
                            Some(start) => {
                                let start = *start as usize - self.begin;
                                to.twin_place[start + place as usize] = m as u32;
                            }
                            None => words.push(Word { cell: other, place, twin_place: m as u32 }),
                        }
                        place
                    }
                };
                to.twin_place[begin + m] = place;
            }
        }
    }

    /// Where a ring that has not changed points back at a cell, whose side towards it was there before.
    fn place_before(&self, own: usize, side: Site) -> u32 {
        let Sides { neighbour, image, twin_place } = &self.before.sides;
        let mut ring = self.before.start[own] as usize..self.before.start[own + 1] as usize;
        ring.find(|&h| (neighbour[h], image[h]) == side).map_or(0, |h| twin_place[h])
    }
}
