//! Cells with their polygons for other programs.

use crate::failure::Failure;
use clap::Args;
use voronudge_geometry::{Tessellation, Vector, polygons};
use voronudge_io::{CellFrame, DataSet, ExportFormat, OutputDirectory, export_cells};

#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// Also write the cells, their polygons and what is known of them for other programs: `csv`, `geojson`, `vtk` (ParaView), `napari`;
    /// several with commas between.
    #[arg(long = "export", value_name = "FORMATS", value_delimiter = ',')]
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

/// The cells of a frame with their polygons and neighbours, without values: `chosen` are those to write, by their number in the
/// tessellation and in the data set.
pub(crate) fn cell_frame(
    frame: usize,
    (tessellation, positions): (&Tessellation, &[Vector<f64>]),
    chosen: &[(usize, usize)],
) -> CellFrame {
    let mut vertices = polygons(tessellation, positions);
    let mut numbers = vec![None; positions.len()];
    chosen.iter().for_each(|&(own, cell)| numbers[own] = Some(cell));
    let neighbours = |own: usize| -> Vec<usize> {
        tessellation.neighbours(own).iter().filter_map(|&other| numbers[other as usize]).collect()
    };
    CellFrame {
        frame,
        cells: chosen.iter().map(|&(_, cell)| cell).collect(),
        positions: chosen.iter().map(|&(own, _)| positions[own]).collect(),
        polygons: chosen.iter().map(|&(own, _)| std::mem::take(&mut vertices[own])).collect(),
        neighbours: chosen.iter().map(|&(own, _)| neighbours(own)).collect(),
        values: Vec::new(),
    }
}
