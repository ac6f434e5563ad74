//! How near a snapshot is to a T1 transition.

use voronudge_geometry::{CellPolygon, Tessellation, Vector};

/// Distance from the next T1 transition, where a side vanishes and the Jacobian jumps: linear modes hold for displacements
/// that are small against it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransitionDistance {
    /// Length of the shortest side of a polygon.
    pub shortest_side: f64,
    /// The two cells that share it.
    pub cells: [usize; 2],
    /// How far the nearest fourth cell is from the circle through three that meet: it would have to move by so much, at
    /// least, to come to lie on it.
    pub smallest_gap: f64,
    /// Sides shorter than the length given.
    pub short_sides: usize,
    /// All sides.
    pub sides: usize,
}

impl TransitionDistance {
    /// Looks at the sides of the cells that count, of the first `cells` of a tessellation; those shorter than `short` are counted. `None` if
    /// there are none. Cells beyond are mirror images of these: at a wall a cell has one side with its own image, and sides without
    /// length with those of its neighbours, which stay so whatever the cells do and are passed over.
    pub fn new(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cells: usize,
        counts: impl Fn(usize) -> bool,
        short: f64,
    ) -> Option<Self> {
        let mut polygon = CellPolygon::default();
        let mut found: Option<Self> = None;
        for cell in (0..cells).filter(|&cell| tessellation.is_closed(cell) && counts(cell)) {
            polygon.fill(tessellation, positions, cell);
            let (ring, corners) = (polygon.ring(), polygon.corners());
            for ((m, h), length) in tessellation.ring(cell).enumerate().zip(polygon.side_lengths()) {
                let other = tessellation.neighbour(h);
                // Of images, only a cell's own in one mirror has a side with it that has a length; that in both is met in a corner.
                let at_wall = other >= cells && (other % cells != cell || (other / cells).count_ones() > 1);
                // Each side once, from the lower number, unless the other cell is not looked at.
                if at_wall || h > tessellation.twin(h) && other < cells && counts(other) {
                    continue;
                }
                let count = ring.len();
                let circle = corners[(m + count - 1) % count].centre;
                let gap = ((ring[(m + 1) % count] - circle).norm() - circle.norm()).abs();
                let side = Self {
                    shortest_side: length.abs(),
                    cells: [cell, other % cells],
                    smallest_gap: gap,
                    short_sides: usize::from(length < short),
                    sides: 1,
                };
                found = Some(found.map_or(side, |found| found.with(side)));
            }
        }
        found
    }

    fn with(self, side: Self) -> Self {
        let shorter = if side.shortest_side < self.shortest_side { side } else { self };
        Self {
            shortest_side: shorter.shortest_side,
            cells: shorter.cells,
            smallest_gap: self.smallest_gap.min(side.smallest_gap),
            short_sides: self.short_sides + side.short_sides,
            sides: self.sides + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voronudge_geometry::{Domain, PeriodicBox};

    /// A square lattice pulled apart by e along x: sides along the diagonals are of the order of e.
    #[test]
    fn nearly_square_cells_are_near_a_transition() {
        for (e, short) in [(1e-3, 16), (0.3, 0)] {
            let positions: Vec<_> = (0..16)
                .map(|i| {
                    let row = (i / 4) as f64;
                    Vector::new((i % 4) as f64 + 0.5 + e * (i / 4 % 2) as f64, row + 0.5)
                })
                .collect();
            let domain = Domain::Periodic(PeriodicBox::new([4.0, 4.0]).unwrap());
            let tessellation = Tessellation::new(&positions, domain).unwrap();
            let found = TransitionDistance::new(&tessellation, &positions, 16, |_| true, 0.01).unwrap();
            assert_eq!((found.sides, found.short_sides), (48, short));
            assert!(found.shortest_side < 2.0 * e && found.smallest_gap < 2.0 * e);
            assert!(found.shortest_side > 0.2 * e && found.smallest_gap > 0.1 * e);
        }
    }
}
