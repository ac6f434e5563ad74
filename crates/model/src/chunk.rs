//! Work on cells, cut into tasks of a fixed number of them.

use std::ops::Range;
use voronudge_geometry::BySides;

/// Cells per task.
pub(crate) const CHUNK: usize = BySides::MOST_CELLS;

/// Cuts an array of per-cell stretches into tasks of [`CHUNK`] cells; `start` gives the first entry of a cell.
pub(crate) fn split_by_cells<T>(
    array: &mut [T],
    cells: usize,
    start: impl Fn(usize) -> usize,
) -> Vec<(Range<usize>, &mut [T])> {
    let mut rest = array;
    let mut tasks = Vec::with_capacity(cells.div_ceil(CHUNK));
    for first in (0..cells).step_by(CHUNK) {
        let last = (first + CHUNK).min(cells);
        let (own, after) = rest.split_at_mut(start(last) - start(first));
        rest = after;
        tasks.push((first..last, own));
    }
    tasks
}
