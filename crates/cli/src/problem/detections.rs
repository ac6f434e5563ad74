//! Between the cells as the fit has them and those that were detected.

use super::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::{ChangeKind, Origin};

impl Problem {
    /// A field over the cells of a frame as the fit has them, in the order of those that were detected; not a number where a
    /// detection is no cell. A cell that was detected twice speaks for the first detection.
    pub fn of_detections(&self, index: usize, of_cells: Vec<Vector<f64>>) -> Vec<Vector<f64>> {
        let Some(completion) = &self.completion else {
            return of_cells;
        };
        let frame = &completion.frames[index];
        let mut field = vec![Vector::new(f64::NAN, f64::NAN); self.snapshots[index].cells.len()];
        for (origin, v) in frame.origins.iter().zip(of_cells) {
            match *origin {
                Origin::Detected(cell) => field[cell] = v,
                Origin::Added(change, _) if frame.changes[change].kind == ChangeKind::Merged => {
                    if let Some(cell) = frame.changes[change].removed.first() {
                        field[*cell] = v;
                    }
                }
                Origin::Added(..) => {}
            }
        }
        field
    }

    /// What belongs to the detections of a frame, for its cells as the fit has them: a cell that was detected twice has that of the first
    /// detection, one that was put in has nothing.
    pub fn of_cells<T: Clone>(&self, index: usize, of_detections: Vec<T>, nothing: &T) -> Vec<T> {
        let Some(completion) = &self.completion else {
            return of_detections;
        };
        let frame = &completion.frames[index];
        let detection = |origin: &Origin| match *origin {
            Origin::Detected(cell) => Some(cell),
            Origin::Added(change, _) => match frame.changes[change].kind {
                ChangeKind::Merged => frame.changes[change].removed.first().copied(),
                _ => None,
            },
        };
        let own = |cell: usize| of_detections.get(cell).unwrap_or(nothing).clone();
        frame.origins.iter().map(|origin| detection(origin).map_or_else(|| nothing.clone(), own)).collect()
    }
}
