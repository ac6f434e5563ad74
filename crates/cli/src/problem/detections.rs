//! Between the cells as the fit has them and those that were detected.

use super::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::{ChangeKind, CompletedFrame, Origin};

impl Problem {
    /// A field over the cells of a frame as the fit has them, in the order of those that were detected; not a number where a
    /// detection is no cell. A cell that was detected twice speaks for the first detection.
    pub fn of_detections(&self, index: usize, of_cells: Vec<Vector<f64>>) -> Vec<Vector<f64>> {
        let nowhere = Vector::new(f64::NAN, f64::NAN);
        self.fitted_cells(index, of_cells.len())
            .into_iter()
            .map(|own| own.map_or(nowhere, |k| of_cells[k]))
            .collect()
    }

    /// For each detection of a frame the number of its cell among the `count` that the fit has; none where a detection is no cell.
    pub fn fitted_cells(&self, index: usize, count: usize) -> Vec<Option<usize>> {
        let Some(completion) = &self.completion else {
            return (0..count).map(Some).collect();
        };
        let frame = &completion.frames[index];
        let mut found = vec![None; self.snapshots[index].cells.len()];
        for (own, origin) in frame.origins.iter().enumerate().take(count) {
            if let Some(cell) = detection(frame, origin) {
                found[cell] = Some(own);
            }
        }
        found
    }

    /// What belongs to the detections of a frame, for its cells as the fit has them: a cell that was detected twice has that of the first
    /// detection, one that was put in has nothing.
    pub fn of_cells<T: Clone>(&self, index: usize, of_detections: Vec<T>, nothing: &T) -> Vec<T> {
        let Some(completion) = &self.completion else {
            return of_detections;
        };
        let frame = &completion.frames[index];
        let own = |cell: usize| of_detections.get(cell).unwrap_or(nothing).clone();
        frame
            .origins
            .iter()
            .map(|origin| detection(frame, origin).map_or_else(|| nothing.clone(), own))
            .collect()
    }
}

/// The detection that a cell of the fit is, or the first of two that are one cell.
fn detection(frame: &CompletedFrame, origin: &Origin) -> Option<usize> {
    match *origin {
        Origin::Detected(cell) => Some(cell),
        Origin::Added(change, _) => match frame.changes[change].kind {
            ChangeKind::Merged => frame.changes[change].removed.first().copied(),
            _ => None,
        },
    }
}
