//! Cells with their polygons for other programs.

use crate::failure::Failure;
use clap::Args;
use voronudge_geometry::{Domain, Tessellation, Vector, areas, perimeters, polygons};
use voronudge_io::{CellFrame, CellValues, DataSet, ExportFormat, OutputDirectory, export_cells};

#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// Also write the cells, their polygons and what is known about them for other programs, in one or more of the
    /// formats `csv`, `geojson`, `vtk` (for ParaView) and `napari`, separated by commas.
    #[arg(long = "export", value_name = "FORMATS", value_delimiter = ',', help_heading = "Output")]
    formats: Vec<ExportFormat>,
}

impl ExportArguments {
    /// Writes what is asked for; frames are made if anything is.
    pub fn write(
        &self,
        out: &mut OutputDirectory,
        data: &DataSet,
        frames: impl FnOnce() -> Vec<CellFrame>,
    ) -> Result<(), Failure> {
        if !self.formats.is_empty() {
            export_cells(out, &self.formats, data, &frames())?;
        }
        Ok(())
    }
}

/// The cells of a frame with their polygons and neighbours, area, perimeter and further values: `chosen` are those to write, by their number
/// in the tessellation and in the data set. In an open field a polygon that reaches beyond all cells counts as open: it would be another one
/// if more had been seen.
pub(crate) fn cell_frame(
    frame: usize,
    (tessellation, positions): (&Tessellation, &[Vector<f64>]),
    chosen: &[(usize, usize)],
    values: impl IntoIterator<Item = (&'static str, CellValues)>,
) -> CellFrame {
    let mut vertices = polygons(tessellation, positions);
    if tessellation.domain() == Domain::Open {
        let far = f64::INFINITY;
        let corners =
            positions.iter().fold([Vector::new(far, far), Vector::new(-far, -far)], |[low, high], r| {
                [low.inf(r), high.sup(r)]
            });
        let [low, high] = corners;
        let is_within = |v: &Vector<f64>| (low.x..=high.x).contains(&v.x) && (low.y..=high.y).contains(&v.y);
        vertices.iter_mut().filter(|own| !own.iter().all(is_within)).for_each(Vec::clear);
    }
    let mut numbers = vec![None; positions.len()];
    chosen.iter().for_each(|&(own, cell)| numbers[own] = Some(cell));
    let neighbours = |own: usize| -> Vec<usize> {
        tessellation.neighbours(own).iter().filter_map(|&other| numbers[other as usize]).collect()
    };
    let of_polygons = |all: Vec<f64>| {
        let value = |own: usize| if vertices[own].is_empty() { f64::NAN } else { all[own] };
        CellValues::Numbers(chosen.iter().map(|&(own, _)| value(own)).collect())
    };
    let shapes = [
        ("area", of_polygons(areas(tessellation, positions))),
        ("perimeter", of_polygons(perimeters(tessellation, positions))),
    ];
    CellFrame {
        frame,
        values: shapes.into_iter().chain(values).collect(),
        cells: chosen.iter().map(|&(_, cell)| cell).collect(),
        positions: chosen.iter().map(|&(own, _)| positions[own]).collect(),
        polygons: chosen.iter().map(|&(own, _)| std::mem::take(&mut vertices[own])).collect(),
        neighbours: chosen.iter().map(|&(own, _)| neighbours(own)).collect(),
    }
}
