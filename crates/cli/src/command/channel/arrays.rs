//! Profiles as files.

use crate::failure::Failure;
use ndarray::{Array1, Array2};
use std::fmt::Write as _;
use voronudge_io::OutputDirectory;
use voronudge_simulate::measure::{ChannelProfile, Estimate};

/// Writes x.npy and face.npy and beside them (places, 2: value, standard error) of each profile, from edge to edge; and the profiles
/// folded about the middle as a table.
pub(super) fn write(
    out: &mut OutputDirectory,
    full: &ChannelProfile,
    folded: &ChannelProfile,
) -> Result<(), Failure> {
    out.write_array("x.npy", Array1::from(full.centres.clone()).view())?;
    out.write_array("face.npy", Array1::from(full.faces.clone()).view())?;
    let [[stress_xx, stress_xy], [stress_yx, stress_yy]] = &full.stress;
    let profiles: [(&str, &[Estimate]); 13] = [
        ("density.npy", &full.density),
        ("velocity_x.npy", &full.velocity[0]),
        ("velocity_y.npy", &full.velocity[1]),
        ("birth_rate.npy", &full.birth_rate),
        ("extrusion_rate.npy", &full.death_rate),
        ("flux_rate.npy", &full.flux_rate),
        ("net_rate.npy", &full.net_rate),
        ("stress_xx.npy", stress_xx),
        ("stress_xy.npy", stress_xy),
        ("stress_yx.npy", stress_yx),
        ("stress_yy.npy", stress_yy),
        ("transport.npy", &full.transport),
        ("torque.npy", &full.torque),
    ];
    for (name, profile) in profiles {
        let array = Array2::from_shape_fn((profile.len(), 2), |(place, column)| match column {
            0 => profile[place].value,
            _ => profile[place].error.unwrap_or(f64::NAN),
        });
        out.write_array(name, array.view())?;
    }
    out.write_text("folded_profile.csv", &table(folded))?;
    Ok(())
}

fn table(folded: &ChannelProfile) -> String {
    let columns: [(&str, &[Estimate]); 5] = [
        ("density", &folded.density),
        ("v_x", &folded.velocity[0]),
        ("v_y", &folded.velocity[1]),
        ("birth_rate", &folded.birth_rate),
        ("extrusion_rate", &folded.death_rate),
    ];
    // Without errors their columns are left out.
    let with_errors = columns.iter().all(|(_, profile)| profile.iter().all(|at| at.error.is_some()));
    let mut text = String::from("x");
    for (name, _) in columns {
        let _ = write!(text, ",{name}");
        if with_errors {
            let _ = write!(text, ",{name}_error");
        }
    }
    text.push('\n');
    for (place, x) in folded.centres.iter().enumerate() {
        let _ = write!(text, "{x}");
        for (_, profile) in columns {
            let at = profile[place];
            let _ = write!(text, ",{}", at.value);
            if let Some(error) = at.error.filter(|_| with_errors) {
                let _ = write!(text, ",{error}");
            }
        }
        text.push('\n');
    }
    text
}
