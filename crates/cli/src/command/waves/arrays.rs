//! The result as arrays.

use super::beside::Beside;
use crate::failure::Failure;
use ndarray::{Array1, Array2, Array3};
use voronudge_io::OutputDirectory;
use voronudge_observables::{Fluctuations, StructurePart};
use voronudge_report::waves_report::Rates;

/// Name of a part of the dynamic structure factor in files.
fn name(part: StructurePart) -> &'static str {
    match part {
        StructurePart::Longitudinal => "longitudinal",
        StructurePart::Transverse => "transverse",
        StructurePart::OddReal => "odd_real",
        StructurePart::OddImaginary => "odd_imaginary",
        StructurePart::Density => "density",
    }
}

/// `dynamical_matrix.npy` (shells, 9): wave number, D row by row, and their standard errors; `dynamical_matrix_model.npy` (shells, 13) beside it: wave number, the projected and the relaxed
/// Jacobian and the theory; `dynamic_structure_*.npy` (shells, frequencies, 2), with `dynamic_structure_frequencies.npy`.
pub(super) fn write(out: &mut OutputDirectory, found: &Fluctuations, beside: &Beside) -> Result<(), Failure> {
    let shells = &found.shells;
    let missing: Rates = [[f64::NAN; 2]; 2];
    let table = Array2::from_shape_fn((shells.len(), 9), |(row, column)| {
        let relaxation = shells[row].relaxation.as_ref();
        let entry = |of: Option<Rates>, k: usize| of.unwrap_or(missing)[k / 2][k % 2];
        match column {
            0 => shells[row].wave_number,
            1..5 => entry(relaxation.map(|own| own.matrix), column - 1),
            _ => entry(relaxation.map(|own| own.standard_errors), column - 5),
        }
    });
    out.write_array("dynamical_matrix.npy", table.view())?;
    if beside.parameters.is_some() {
        let table = Array2::from_shape_fn((shells.len(), 13), |(row, column)| {
            let own = beside.shells[row];
            let Some(k) = column.checked_sub(1) else { return shells[row].wave_number };
            let all = [own.projected, own.relaxed, own.theory];
            all[k / 4].unwrap_or(missing)[k % 4 / 2][k % 2]
        });
        out.write_array("dynamical_matrix_model.npy", table.view())?;
    }
    if let Some(structure) = &found.structure {
        let frequencies = Array1::from(structure.frequencies.clone());
        out.write_array("dynamic_structure_frequencies.npy", frequencies.view())?;
        for (part, all) in StructurePart::ALL.into_iter().zip(&structure.parts) {
            let shape = (all.len(), structure.frequencies.len(), 2);
            let table =
                Array3::from_shape_fn(shape, |(shell, frequency, which)| all[shell][frequency][which]);
            out.write_array(&format!("dynamic_structure_{}.npy", name(part)), table.view())?;
        }
    }
    Ok(())
}
