//! T1 transitions: what lies between two tessellations of the same cells.

use crate::Tessellation;

/// A side that vanishes and the one that appears in its place, between the other two of the four cells that met at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// A cell and its half-edge that is lost, in the tessellation before.
    pub lost: (usize, usize),
    /// A cell and its half-edge that is gained, in the tessellation after.
    pub gained: (usize, usize),
}

/// A Delaunay edge as [`Tessellation::edges`] gives it.
type Edge = (u32, u32, [i16; 2]);

impl Transition {
    /// The transitions that lead from one tessellation to another of the same cells, in the order of the cells that part.
    ///
    /// Each of them exchanges one side while those around it stay. Where sides next to each other have changed both, what lies between is
    /// a sequence that two tessellations do not tell; such sides are left out, as are those of open polygons.
    pub fn between(before: &Tessellation, after: &Tessellation) -> Vec<Self> {
        let mut found = Vec::new();
        for cell in (0..before.len()).filter(|cell| !before.has_ring_of(after, *cell)) {
            for h in before.ring(cell).filter(|h| *h < before.twin(*h)) {
                if after.has_edge(before, (cell, h)) {
                    continue;
                }
                let Some([from, to]) = before.opposite(cell, h) else { continue };
                let edge = ordered(before.neighbour(from), before.neighbour(to), before.between(from, to));
                if before.half_edge(edge).is_some() {
                    continue;
                }
                let Some(gained) = after.half_edge(edge) else { continue };
                let Some([one, other]) = after.opposite(gained.0, gained.1) else { continue };
                let faces = ordered(after.neighbour(one), after.neighbour(other), after.between(one, other));
                if faces == before.edge(cell, h) {
                    found.push(Self { lost: (cell, h), gained });
                }
            }
        }
        found
    }
}

impl Tessellation {
    /// The half-edges of a cell next to one of them, clockwise and counter-clockwise: those to the third corners of its triangles. `None`
    /// where the polygon of one of the four cells is open.
    pub fn opposite(&self, cell: usize, h: usize) -> Option<[usize; 2]> {
        let [before, after] = self.beside(cell, h)?;
        let cells = [cell, self.neighbour(h), self.neighbour(before), self.neighbour(after)];
        cells.iter().all(|cell| self.is_closed(*cell)).then_some([before, after])
    }

    /// Whether there is the edge that a half-edge of a cell is in another tessellation of the same cells.
    pub fn has_edge(&self, other: &Self, (cell, h): (usize, usize)) -> bool {
        self.half_edge(other.edge(cell, h)).is_some()
    }

    /// Whether the ring of a cell is the same in another tessellation, begun at the same neighbour.
    fn has_ring_of(&self, other: &Self, cell: usize) -> bool {
        let [own, theirs] = [self, other].map(|tessellation| tessellation.ring(cell));
        self.neighbour[own.clone()] == other.neighbour[theirs.clone()]
            && self.image[own] == other.image[theirs]
    }

    /// The edge of a half-edge, as in [`edges`](Self::edges).
    fn edge(&self, cell: usize, h: usize) -> Edge {
        ordered(cell, self.neighbour(h), self.image(h))
    }

    /// Lattice vectors from what one half-edge of a cell points at to what another does.
    fn between(&self, from: usize, to: usize) -> [i16; 2] {
        let (from, to) = (self.image(from), self.image(to));
        [to[0] - from[0], to[1] - from[1]]
    }

    /// The cell and half-edge of an edge.
    fn half_edge(&self, (from, to, image): Edge) -> Option<(usize, usize)> {
        let cell = from as usize;
        let found = self.ring(cell).find(|h| self.neighbour[*h] == to && self.image[*h] == image)?;
        Some((cell, found))
    }
}

/// An edge from the lower to the higher cell.
fn ordered(from: usize, to: usize, image: [i16; 2]) -> Edge {
    let (a, b) = (from as u32, to as u32);
    if a <= b { (a, b, image) } else { (b, a, [-image[0], -image[1]]) }
}
