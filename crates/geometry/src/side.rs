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
        let ([on_a, on_b], [also_on_b, on_c]) = (first.pull_back(-t), second.pull_back(t));
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
