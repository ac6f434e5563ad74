//! Cells with their polygons as other programs read them.

mod csv;
mod geojson;
mod vtk;

use crate::output::OutputDirectory;
use crate::{DataSet, Error};
use std::str::FromStr;
use voronudge_geometry::Vector;

/// A format for cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// `cells.csv`, a row for each cell and frame.
    Csv,
    /// `cells.geojson`, a polygon for each cell and frame.
    Geojson,
    /// `cells.pvd` and `cells_0000.vtp`, …, polygons with their data for ParaView.
    Vtk,
    /// `napari-tracks.csv`, rows of a tracks layer of napari with properties.
    Napari,
}

impl FromStr for ExportFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "csv" => Ok(Self::Csv),
            "geojson" => Ok(Self::Geojson),
            "vtk" => Ok(Self::Vtk),
            "napari" => Ok(Self::Napari),
            _ => Err("the formats are csv, geojson, vtk and napari".into()),
        }
    }
}

/// What is known of the cells of a frame.
#[derive(Debug, Clone)]
pub enum CellValues {
    /// A number for each cell (N); not a number where there is none.
    Numbers(Vec<f64>),
    /// A vector for each cell (N); not a number where there is none.
    Vectors(Vec<Vector<f64>>),
}

/// The cells of one frame, in the units of the data, y up.
#[derive(Debug, Clone)]
pub struct CellFrame {
    /// Number of the frame in the data set.
    pub frame: usize,
    /// Numbers of the cells (N) in the data set.
    pub cells: Vec<usize>,
    /// Where they are (N).
    pub positions: Vec<Vector<f64>>,
    /// Vertices of their polygons (N), none of an open one.
    pub polygons: Vec<Vec<Vector<f64>>>,
    /// Numbers of their neighbours (N) in the data set, counter-clockwise; those that were not detected are left out.
    pub neighbours: Vec<Vec<usize>>,
    /// Named values; the same names in all frames.
    pub values: Vec<(&'static str, CellValues)>,
}

/// Numbers of one cell by name: vectors are two, `name_x` and `name_y`.
fn numbers(frame: &CellFrame, cell: usize, y_sign: f64) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for (name, values) in &frame.values {
        match values {
            CellValues::Numbers(values) => found.push(((*name).to_owned(), values[cell])),
            CellValues::Vectors(values) => {
                found.push((format!("{name}_x"), values[cell].x));
                found.push((format!("{name}_y"), y_sign * values[cell].y));
            }
        }
    }
    found
}

/// Writes cells in these formats, with y as in the files of the data set.
///
/// # Errors
/// [`Error`] if a file cannot be written.
pub fn export_cells(
    out: &mut OutputDirectory,
    formats: &[ExportFormat],
    data: &DataSet,
    frames: &[CellFrame],
) -> Result<(), Error> {
    let y_sign = data.y_sign();
    let time = |frame: usize| data.frame_interval * frame as f64;
    for format in formats {
        match format {
            ExportFormat::Csv => out.write_text("cells.csv", &csv::table(frames, y_sign, time))?,
            ExportFormat::Napari => out.write_text("napari-tracks.csv", &csv::tracks(frames, y_sign))?,
            ExportFormat::Geojson => {
                out.write_text("cells.geojson", &geojson::collection(frames, y_sign, time))?;
            }
            ExportFormat::Vtk => {
                out.write_text("cells.pvd", &vtk::series(frames, time))?;
                for frame in frames {
                    out.write_text(&vtk::name(frame.frame), &vtk::polygons(frame, y_sign))?;
                }
            }
        }
    }
    Ok(())
}
