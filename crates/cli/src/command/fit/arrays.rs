//! Positions and velocities of a fit as arrays.

use super::prepare::Prepared;
use crate::failure::Failure;
use crate::snapshot::to_array;
use voronudge_geometry::Vector;
use voronudge_infer::Inference;
use voronudge_io::{DataSet, OutputDirectory};

/// Writes the nudged positions, and what the model says of the velocities; names begin with `prefix`.
pub(crate) fn write(
    out: &mut OutputDirectory,
    prefix: &str,
    data: &DataSet,
    prepared: &Prepared,
    result: &Inference,
) -> Result<(), Failure> {
    type Field = fn(&Prepared, &Inference, usize) -> Vec<Vector<f64>>;
    let all = |field: Field| -> Vec<Vec<Vector<f64>>> {
        (0..prepared.snapshots.len()).map(|index| field(prepared, result, index)).collect()
    };
    let mut of_cells: Vec<(&str, Field)> = vec![
        ("nudged_positions.npy", Prepared::nudged_positions),
        ("predicted_velocities.npy", Prepared::predicted),
    ];
    match prepared.velocities.flow() {
        None => of_cells.push(("residual_velocities.npy", Prepared::residual_data)),
        Some(field) => {
            for (name, of) in [
                ("predicted_flow.npy", Prepared::predicted_data as Field),
                ("residual_flow.npy", Prepared::residual_data),
            ] {
                out.write_array(&format!("{prefix}{name}"), field.to_array(data, &all(of)).view())?;
            }
        }
    }
    if result.frames.iter().any(|frame| !frame.polarities.is_empty()) {
        of_cells.push(("polarities.npy", Prepared::polarities));
    }
    for (name, field) in of_cells {
        let fields = all(field);
        let frames = prepared.snapshots.iter().zip(&fields).map(|(snapshot, f)| (snapshot, f.as_slice()));
        out.write_array(&format!("{prefix}{name}"), to_array(data, frames).view())?;
    }
    Ok(())
}
