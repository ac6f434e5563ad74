//! The cells of a fit for other programs.

use crate::arguments::cell_frame;
use crate::problem::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::Inference;
use voronudge_io::{CellFrame, CellValues};

/// The cells of all frames where the fit has them, with their polygons there, and how they move.
pub(crate) fn frames(prepared: &Problem, result: &Inference) -> Vec<CellFrame> {
    (0..prepared.snapshots.len()).map(|index| frame(prepared, result, index)).collect()
}

fn frame(prepared: &Problem, result: &Inference, index: usize) -> CellFrame {
    let (snapshot, fitted) = (&prepared.snapshots[index], &result.frames[index]);
    let positions: Vec<Vector<f64>> =
        fitted.nudged_positions.iter().map(|r| r * prepared.scale.length).collect();
    // Each detection that is a cell: which it is of the fit, and its number in the data set.
    let of_detections = prepared.fitted_cells(index, positions.len());
    let (detections, chosen): (Vec<usize>, Vec<(usize, usize)>) = (of_detections.into_iter().enumerate())
        .filter_map(|(detection, own)| Some((detection, (own?, snapshot.cells[detection]))))
        .unzip();
    let vectors = |all: Vec<Vector<f64>>| {
        CellValues::Vectors(detections.iter().map(|&detection| all[detection]).collect())
    };
    let nudged = prepared.nudged_positions(result, index);
    let nudges = nudged.iter().zip(&snapshot.positions).map(|(nudged, measured)| nudged - measured).collect();
    let mut values =
        vec![("nudge", vectors(nudges)), ("predicted_velocity", vectors(prepared.predicted(result, index)))];
    if prepared.velocities.flow().is_none() {
        values.push(("residual_velocity", vectors(prepared.residual_data(result, index))));
    }
    cell_frame(prepared.frames[index], (&fitted.tessellation, &positions), &chosen, values)
}
