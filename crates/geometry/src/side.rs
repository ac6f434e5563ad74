//! One side of the tessellation, and what moves it towards a T1 transition.

use crate::{Corner, Tessellation, Vector, dot, side_direction};

/// The Voronoi side between two cells, its length, and how the length changes with the four cells that meet at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// The two cells that the side separates, then the two that it would join: the third corners of its triangles,
    /// clockwise and counter-clockwise of the side as seen from the first cell.
    pub cells: [usize; 4],
    /// Length ℓ, in the unit of the positions. It falls through zero where the side turns into one between the other two.
    pub length: f64,
    /// ∂ℓ/∂r of each of the four cells, at frozen topology.
    pub gradient: [Vector<f64>; 4],
}

impl Side {
    /// The side that half-edge `h` of `cell` points across. `None` where an open field's side has no end.
    ///
    /// With the unit vector t along the side, `ℓ = (c₂ − c₁)·t` and `dℓ = t·dc₂ − t·dc₁`, because a change of t is
    /// perpendicular to the side.
    pub fn new(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cell: usize,
        h: usize,
    ) -> Option<Self> {
        let [before, after] = tessellation.beside(cell, h)?;
        let [a, b, c] = [before, h, after].map(|h| tessellation.displacement(positions, cell, h));
        let t = side_direction(b);
        let (first, second) = (Corner::new(a, b), Corner::new(b, c));
        let ([on_a, on_b], [also_on_b, on_c]) = (first.transmit(-t), second.transmit(t));
        let on_b = on_b + also_on_b;
        Some(Self {
            cells: [
                cell,
                tessellation.neighbour(h),
                tessellation.neighbour(before),
                tessellation.neighbour(after),
            ],
            length: dot(second.centre - first.centre, t),
            gradient: [-(on_a + on_b + on_c), on_b, on_a, on_c],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Domain, PeriodicBox};

    #[test]
    fn gradients_are_those_of_the_lengths() {
        let positions: Vec<Vector<f64>> = (0..36)
            .map(|i| {
                let x = f64::from(i);
                Vector::new(f64::from(i % 6) + 0.25 * x.sin(), f64::from(i / 6) + 0.25 * (2.0 * x).cos())
            })
            .collect();
        let domain = Domain::Periodic(PeriodicBox::new([6.0, 6.0]).unwrap());
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let length = |positions: &[Vector<f64>], cell, h| {
            Side::new(&tessellation, positions, cell, h).map(|side| side.length).unwrap()
        };
        for cell in 0..36 {
            for h in tessellation.ring(cell) {
                let side = Side::new(&tessellation, &positions, cell, h).unwrap();
                let seen_from_there =
                    Side::new(&tessellation, &positions, tessellation.neighbour(h), tessellation.twin(h))
                        .unwrap();
                assert!((side.length - seen_from_there.length).abs() < 1e-12);
                for (moved, gradient) in side.cells.iter().zip(side.gradient) {
                    for axis in 0..2 {
                        let step = 1e-6;
                        let at = |sign: f64| {
                            let mut positions = positions.clone();
                            positions[*moved][axis] += sign * step;
                            length(&positions, cell, h)
                        };
                        let difference = (at(1.0) - at(-1.0)) / (2.0 * step);
                        let scale = 1.0 + gradient.norm();
                        assert!(
                            (difference - gradient[axis]).abs() < 1e-6 * scale,
                            "{difference} {gradient}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_side_without_an_end_is_none() {
        let corners = [[0.0, 0.0], [1.0, 0.1], [0.4, 1.0], [0.5, 0.4]].map(|[x, y]| Vector::new(x, y));
        let tessellation = Tessellation::new(&corners, Domain::Open).unwrap();
        let count = (0..4)
            .flat_map(|cell| tessellation.ring(cell).map(move |h| (cell, h)))
            .filter(|&(cell, h)| Side::new(&tessellation, &corners, cell, h).is_some())
            .count();
        // Three sides meet at the inner cell, each seen from two cells; from those on the hull one end is missing for
        // the sides between them only.
        assert_eq!(count, 6);
    }
}
