//! Positions and velocities of a fit as arrays.

use crate::failure::Failure;
use crate::problem::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::Inference;
use voronudge_io::{DataSet, OutputDirectory};

/// Writes the nudged positions, and what the model says of the velocities; names begin with `prefix`.
pub(crate) fn write(
    out: &mut OutputDirectory,
    prefix: &str,
    data: &DataSet,
    prepared: &Problem,
    result: &Inference,
) -> Result<(), Failure> {
    type Field = fn(&Problem, &Inference, usize) -> Vec<Vector<f64>>;
    let all = |field: Field| -> Vec<Vec<Vector<f64>>> {
        (0..prepared.snapshots.len()).map(|index| field(prepared, result, index)).collect()
    };
    let mut of_cells: Vec<(&str, Field)> = vec![
        ("nudged_positions.npy", Problem::nudged_positions),
        ("predicted_velocities.npy", Problem::predicted),
    ];
    match prepared.velocities.flow() {
        None => of_cells.push(("residual_velocities.npy", Problem::residual_data)),
        Some(field) => {
            for (name, of) in [
                ("predicted_flow.npy", Problem::predicted_data as Field),
                ("residual_flow.npy", Problem::residual_data),
            ] {
                out.write_array(&format!("{prefix}{name}"), field.to_array(data, &all(of)).view())?;
            }
        }
    }
    if result.frames.iter().any(|frame| !frame.polarities.is_empty()) {
        of_cells.push(("polarities.npy", Problem::polarities));
    }
    for (name, field) in of_cells {
        let fields = all(field);
        let frames = prepared.snapshots.iter().zip(&fields).map(|(snapshot, f)| (snapshot, f.as_slice()));
        out.write_array(&format!("{prefix}{name}"), data.vectors_as_given(frames).view())?;
    }
    Ok(())
}
