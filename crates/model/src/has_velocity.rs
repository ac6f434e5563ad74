//! Which cells have a velocity.

use voronudge_geometry::Tessellation;

/// Whether the polygon of a cell and those of its neighbours are closed.
pub(crate) fn has_velocity(tessellation: &Tessellation, cell: usize) -> bool {
    tessellation.is_closed(cell)
        && tessellation.neighbours(cell).iter().all(|&k| tessellation.is_closed(k as usize))
}
