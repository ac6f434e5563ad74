//! The edge of an open field.

use crate::{Tessellation, Vector};

/// Whether the way along the hull, from each cell to the first of its ring, passes all cells of it and turns once.
///
/// With angles below π at all of its cells and counter-clockwise triangles inside, which the angles of all triangles then leave no room to cover
/// anything twice, the cells still have this hull: the sum of the angles about each cell within is 2π or more of them, and all together are
///
/// ```text
/// π (triangles) = 2π (cells within) + π (cells of the hull) − 2π (turns)
/// ```
pub(super) fn turns_once(tessellation: &Tessellation, positions: &[Vector<f64>]) -> bool {
    let on_hull = &tessellation.on_hull;
    let Some(first) = on_hull.iter().position(|on_hull| *on_hull) else {
        return false;
    };
    let next = |cell: usize| tessellation.neighbour(tessellation.ring(cell).start);
    let is_upwards = |cell: usize| {
        let along = positions[next(cell)] - positions[cell];
        along.y > 0.0 || (along.y == 0.0 && along.x > 0.0)
    };
    let (mut cell, mut cells, mut turns) = (first, 0, 0);
    loop {
        let to = next(cell);
        turns += usize::from(is_upwards(to) && !is_upwards(cell));
        (cell, cells) = (to, cells + 1);
        if cell == first || cells > on_hull.len() {
            break;
        }
    }
    turns == 1 && cells == on_hull.iter().filter(|on_hull| **on_hull).count()
}
