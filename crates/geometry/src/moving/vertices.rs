//! Cells are taken out of a triangulation and put into one.

use super::diagonal::Site;
use super::lawson::{Lawson, Ring};
use super::scan::Edge;
use crate::{Tessellation, Vector, cross};

/// Triangles on the way to the one that a cell is in, at most.
const WAY: usize = 200;

/// Twice the area of a triangle, in squares of its sides, below which it is taken for flat.
const FLAT: f64 = 1e-10;

/// A site as it is seen from one that is itself at an image.
fn seen_from((_, origin): Site, (cell, image): Site) -> Site {
    (cell, [image[0] - origin[0], image[1] - origin[1]])
}

/// The same the other way: a site that is seen from another one, as whoever sees that one sees it.
fn seen_beyond((_, origin): Site, (cell, image): Site) -> Site {
    (cell, [image[0] + origin[0], image[1] + origin[1]])
}

/// How surely three points are counter-clockwise: twice the area of their triangle in squares of its sides.
fn turn(a: Vector<f64>, b: Vector<f64>, c: Vector<f64>) -> f64 {
    let (first, second) = (b - a, c - a);
    cross(first, second) / (first.norm_squared() + second.norm_squared())
}

impl Lawson {
    /// The ring of a cell as it is now.
    pub fn sites<'a>(
        &'a self,
        tessellation: &'a Tessellation,
        cell: usize,
    ) -> impl Iterator<Item = Site> + 'a {
        let (changed, own) = (self.ring(cell), tessellation.ring(cell));
        let sides = changed.map_or(own.len(), <[Site]>::len);
        (0..sides).map(move |m| match changed {
            Some(ring) => ring[m],
            None => (tessellation.neighbour[own.start + m], tessellation.image[own.start + m]),
        })
    }

    /// Takes none of the edges of a cell for a Delaunay edge.
    pub fn suspect_all_of(&mut self, tessellation: &Tessellation, cell: u32) {
        let edges: Vec<Edge> =
            self.sites(tessellation, cell as usize).map(|to| Edge { from: cell, to }).collect();
        self.queue.extend(edges);
    }

    /// Takes a cell out: its edges are flipped away until three are left, and with these it goes. Tells the cells that were around; `None` if it meets
    /// itself, or rounding leaves no edge that is surely one to be flipped.
    pub fn take_out(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: u32,
    ) -> Option<Vec<u32>> {
        let domain = tessellation.domain();
        let around: Vec<u32> = self.sites(tessellation, cell as usize).map(|site| site.0).collect();
        if around.contains(&cell) {
            return None;
        }
        let mut ring: Vec<Site> = self.sites(tessellation, cell as usize).collect();
        while ring.len() > 3 {
            let at = |m: usize| {
                let (other, image) = ring[m % ring.len()];
                domain.displacement(positions[cell as usize], positions[other as usize], image)
            };
            // The triangle that is cut off, and what the cell keeps of the two beside that edge.
            let surely = |m: &usize| {
                let [before, here, after] = [*m + ring.len() - 1, *m, *m + 1].map(at);
                turn(before, here, after).min(turn(before, after, Vector::zeros()))
            };
            let best = (0..ring.len()).max_by(|a, b| surely(a).total_cmp(&surely(b)))?;
            if surely(&best) < FLAT {
                return None;
            }
            let [before, after] = [best + ring.len() - 1, best + 1].map(|m| ring[m % ring.len()]);
            if !self.flip(tessellation, [(cell, [0, 0]), before, ring[best], after]) {
                return None;
            }
            ring.remove(best);
        }
        for (other, [x, y]) in ring {
            let theirs = self.touch(tessellation, other);
            let own = theirs.iter().position(|site| *site == (cell, [-x, -y]))?;
            theirs.remove(own);
        }
        self.touch(tessellation, cell).clear();
        self.queue.clear();
        Some(around)
    }

    /// Puts a cell, at the image that is seen from another cell near it, into the triangle where it is. Its edges wait to be looked at. `None` if
    /// it is on an edge, to rounding.
    pub fn put_in(
        &mut self,
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: Site,
        near: u32,
    ) -> Option<()> {
        let domain = tessellation.domain();
        let at = |(other, image): Site| {
            domain.displacement(positions[near as usize], positions[other as usize], image)
        };
        let own = at(cell);
        let ring: Vec<Site> = self.sites(tessellation, near as usize).collect();
        let towards = (0..ring.len()).map(|m| [ring[m], ring[(m + 1) % ring.len()]]);
        let [first, second] = towards
            .into_iter()
            .find(|[first, second]| cross(at(*first), own) >= 0.0 && cross(own, at(*second)) > 0.0)?;
        let mut triangle = [(near, [0, 0]), first, second];
        let mut way = 0..WAY;
        let within = loop {
            way.next()?;
            let sides = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3]]);
            let side = |[from, to]: [Site; 2]| turn(at(from), at(to), own);
            if sides.iter().all(|own| side(*own) > FLAT) {
                break sides;
            }
            let [from, to] = *sides.iter().min_by(|a, b| side(**a).total_cmp(&side(**b)))?;
            if side([from, to]) > -FLAT {
                return None;
            }
            // Behind that side there is the site before its end in the ring of its beginning.
            let ring: Vec<Site> = self.sites(tessellation, from.0 as usize).collect();
            let end = ring.iter().position(|site| *site == seen_from(from, to))?;
            let behind = ring[(end + ring.len() - 1) % ring.len()];
            triangle = [from, seen_beyond(from, behind), to];
        };
        for [from, to] in within {
            let theirs = self.touch(tessellation, from.0);
            let end = theirs.iter().position(|site| *site == seen_from(from, to))?;
            theirs.insert(end + 1, seen_from(from, cell));
            self.queue.push(Edge { from: from.0, to: seen_from(from, to) });
        }
        let corners = within.map(|[from, _]| seen_from(cell, from));
        *self.touch(tessellation, cell.0) = Ring::from_slice(&corners);
        Some(())
    }
}
