//! Arrays over cells and half-edges, cut into tasks.

/// Cells per task.
pub(super) const CHUNK: usize = crate::BySides::MOST_CELLS;

/// Cuts an array into stretches of given lengths.
pub(super) fn into_stretches<'a, T>(array: &'a mut [T], lengths: &[usize]) -> Vec<&'a mut [T]> {
    let mut rest = array;
    let stretch = |length: &usize| rest.split_off_mut(..*length).unwrap_or_default();
    lengths.iter().map(stretch).collect()
}
