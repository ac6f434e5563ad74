//! Cells come and go: what is around them is made anew, all else stays as it is.

use super::lawson::Lawson;
use super::splice::Splice;
use super::{MovingTessellation, Renewal};
use crate::builder::find_twins;
use crate::domain::MOST_BOXES;
use crate::{Domain, Error, PeriodicBox, Tessellation, Vector};
use std::collections::HashMap;

/// Cells from which on it is worth while, and of how many one may come or go.
const FEWEST: usize = 60;
const OF_SO_MANY: usize = 10;

/// A cell that is gone.
const GONE: u32 = u32::MAX;

impl MovingTessellation {
    /// The tessellation of other cells at positions (N), most of which are where they were, in their order.
    ///
    /// Holes that cells leave are filled with triangles of those around, new cells are put into the triangles where they are, and Lawson's flips
    /// do the rest. The arrays are those of [`Tessellation::new`]; where that is not sure it is built anew, as an open field is.
    ///
    /// # Errors
    /// As [`Tessellation::new`].
    pub fn exchanged(&self, positions: &[Vector<f64>], domain: Domain) -> Result<(Self, Renewal), Error> {
        Ok(match self.exchange(positions, domain) {
            Some((tessellation, flips)) => (Self::of(tessellation, positions), Renewal::Flipped(flips)),
            None => (Self::new(positions, domain)?, Renewal::Rebuilt),
        })
    }

    fn exchange(&self, positions: &[Vector<f64>], domain: Domain) -> Option<(Tessellation, usize)> {
        let Domain::Periodic(cell_box) = domain else { return None };
        let [width, height] = cell_box.lengths();
        let near = MOST_BOXES * width.min(height);
        let are_few = self.positions.len().min(positions.len()) < FEWEST;
        let is_far = |r: &Vector<f64>| !(r.x.abs() < near && r.y.abs() < near);
        if !self.sound || domain != self.tessellation.domain() || are_few || positions.iter().any(is_far) {
            return None;
        }
        let after = followed(&self.positions, positions)?;
        let mut lawson = Lawson::default();
        lawson.begin(self.tessellation.len());
        let mut around = Vec::new();
        for (cell, _) in after.iter().enumerate().filter(|(_, after)| **after == GONE) {
            around.extend(lawson.take_out(&self.tessellation, &self.positions, cell as u32)?);
        }
        lawson.conclude(&self.tessellation);
        let mut next = renumbered(&self.tessellation, &lawson, &after, positions.len())?;
        lawson.begin(next.len());
        // Ties are decided by the numbers that cells have now.
        for cell in around.into_iter().map(|cell| after[cell as usize]).filter(|cell| *cell != GONE) {
            lawson.suspect_all_of(&next, cell);
        }
        let mut flips = lawson.flip_all(&next, positions).ok()?;
        let mut is_new = vec![true; positions.len()];
        after.iter().filter(|after| **after != GONE).for_each(|after| is_new[*after as usize] = false);
        for cell in (0..positions.len()).filter(|cell| is_new[*cell]) {
            let distance =
                |other: &usize| domain.shortest(positions[cell] - positions[*other]).norm_squared();
            let stay = (0..positions.len()).filter(|other| !is_new[*other]);
            let nearest = stay.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            let image = image_near(&cell_box, positions[nearest], positions[cell])?;
            lawson.put_in(&next, positions, (cell as u32, image), nearest as u32)?;
            flips += lawson.flip_all(&next, positions).ok()?;
        }
        lawson.conclude(&next);
        Splice::default().splice(&mut next, &lawson);
        Some((next, flips))
    }
}

/// The number that each cell has among others, in the same order, if it is still where it was. `None` if the order is another, or many are not.
fn followed(before: &[Vector<f64>], now: &[Vector<f64>]) -> Option<Vec<u32>> {
    let place = |r: &Vector<f64>| [r.x.to_bits(), r.y.to_bits()];
    let stays = |cell: usize| now.get(cell).is_some_and(|r| place(r) == place(&before[cell]));
    let others = (0..now.len()).filter(|cell| *cell >= before.len() || !stays(*cell));
    let elsewhere: HashMap<[u64; 2], usize> = others.map(|cell| (place(&now[cell]), cell)).collect();
    let number =
        |cell: usize| if stays(cell) { Some(cell) } else { elsewhere.get(&place(&before[cell])).copied() };
    let after: Vec<u32> = (0..before.len()).map(|cell| number(cell).map_or(GONE, |own| own as u32)).collect();
    let left: Vec<u32> = after.iter().copied().filter(|after| *after != GONE).collect();
    let exchanged = before.len() + now.len() - 2 * left.len();
    let is_ordered = left.windows(2).all(|pair| pair[0] < pair[1]);
    (is_ordered && OF_SO_MANY * exchanged <= now.len()).then_some(after)
}

/// A triangulation under other numbers in the same order, so that the lowest neighbour stays the lowest. Cells that are new have no ring yet.
fn renumbered(before: &Tessellation, changes: &Lawson, after: &[u32], cells: usize) -> Option<Tessellation> {
    let mut next = Tessellation {
        domain: before.domain(),
        start: vec![0; cells + 1],
        neighbour: Vec::with_capacity(before.half_edges()),
        image: Vec::with_capacity(before.half_edges()),
        twin_place: Vec::new(),
        on_hull: vec![false; cells],
    };
    let (mut ring, mut filled) = (Vec::new(), 0);
    for (cell, own) in after.iter().enumerate().filter(|(_, own)| **own != GONE) {
        next.start[filled..=*own as usize].fill(next.neighbour.len() as u32);
        filled = *own as usize + 1;
        ring.clear();
        ring.extend(changes.sites(before, cell).map(|(other, image)| (after[other as usize], image)));
        if ring.iter().any(|(other, _)| *other == GONE) {
            return None;
        }
        next.neighbour.extend(ring.iter().map(|site| site.0));
        next.image.extend(ring.iter().map(|site| site.1));
    }
    next.start[filled..].fill(next.neighbour.len() as u32);
    find_twins(&mut next).ok()?;
    Some(next)
}

/// The image of a cell that is nearest to another.
fn image_near(cell_box: &PeriodicBox, from: Vector<f64>, to: Vector<f64>) -> Option<[i16; 2]> {
    let between = to - from;
    let nearest = cell_box.shortest(between);
    let [x, y] = cell_box.image(between - nearest + cell_box.translation([1, 1]) * 0.5);
    let image = [i16::try_from(-x).ok()?, i16::try_from(-y).ok()?];
    let off = Domain::Periodic(*cell_box).displacement(from, to, image) - nearest;
    (off.norm() < 1e-6 * cell_box.lengths()[0]).then_some(image)
}
