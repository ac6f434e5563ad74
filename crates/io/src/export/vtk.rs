//! Cells as polygons of VTK, which ParaView opens.

use super::{CellFrame, CellValues};
use std::fmt::Write as _;

/// Name of the file of a frame.
pub(super) fn name(frame: usize) -> String {
    format!("cells_{frame:04}.vtp")
}

/// The frames with their times.
pub(super) fn series(frames: &[CellFrame], time: impl Fn(usize) -> f64) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for frame in frames {
        let _ = writeln!(
            text,
            "<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>",
            time(frame.frame),
            name(frame.frame)
        );
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// The cells of a frame that have a closed polygon, with their data.
pub(super) fn polygons(frame: &CellFrame, y_sign: f64) -> String {
    let closed: Vec<usize> =
        (0..frame.cells.len()).filter(|&cell| !frame.polygons[cell].is_empty()).collect();
    let vertices = || closed.iter().flat_map(|&cell| &frame.polygons[cell]);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{}\" NumberOfPolys=\"{}\">\n<Points>\n",
        vertices().count(),
        closed.len()
    );
    let points = vertices().flat_map(|r| [r.x, y_sign * r.y, 0.0]);
    array(&mut text, ("Float64", "Points", 3), points);
    text += "</Points>\n<Polys>\n";
    array(&mut text, ("Int64", "connectivity", 1), (0..vertices().count()).map(|k| k as f64));
    let ends = closed.iter().scan(0, |end, &cell| {
        *end += frame.polygons[cell].len();
        Some(*end as f64)
    });
    array(&mut text, ("Int64", "offsets", 1), ends);
    text += "</Polys>\n<CellData>\n";
    array(&mut text, ("Int64", "cell", 1), closed.iter().map(|&cell| frame.cells[cell] as f64));
    for (name, values) in &frame.values {
        match values {
            CellValues::Numbers(values) => {
                array(&mut text, ("Float64", name, 1), closed.iter().map(|&cell| values[cell]));
            }
            CellValues::Vectors(values) => {
                let flat = closed.iter().flat_map(|&cell| [values[cell].x, y_sign * values[cell].y, 0.0]);
                array(&mut text, ("Float64", name, 3), flat);
            }
        }
    }
    text + "</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n"
}

fn array(
    text: &mut String,
    (kind, name, components): (&str, &str, usize),
    values: impl Iterator<Item = f64>,
) {
    let _ = write!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for value in values {
        // Readers of VTK know nan in small letters.
        let _ = if value.is_nan() { write!(text, " nan") } else { write!(text, " {value}") };
    }
    *text += "</DataArray>\n";
}
