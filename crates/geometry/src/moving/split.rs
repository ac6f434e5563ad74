//! Arrays over cells and half-edges, cut into tasks.

/// Cells per task.
pub(super) const CHUNK: usize = crate::BySides::MOST_CELLS;

/// Cuts an array over half-edges into the stretches of [`CHUNK`] cells each.
pub(super) fn by_cells<'a, T>(array: &'a mut [T], start: &[u32]) -> Vec<&'a mut [T]> {
    let cells = start.len() - 1;
    let mut rest = array;
    let mut stretches = Vec::with_capacity(cells.div_ceil(CHUNK));
    for first in (0..cells).step_by(CHUNK) {
        let last = (first + CHUNK).min(cells);
        let (own, after) = rest.split_at_mut((start[last] - start[first]) as usize);
        rest = after;
        stretches.push(own);
    }
    stretches
}
