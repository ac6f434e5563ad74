//! Importing outlines: the corners of each cell's polygon as rows of a table.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use voronudge_geometry::Vector;
use voronudge_segmentation::{Outline, outline_contacts, outline_interfaces};

use crate::boundary::Boundary;
use crate::error::{Error, ImageFault, image_error};
use crate::image_scale::ImageScale;
use crate::input::read_input;
use crate::shapes::{SeenCell, SeenFrame, ShapeImport, ShapeSummary, assemble};
use crate::table::{ColumnNames, Layout, read_spots};
use crate::tracks::frame_span;

/// Corners that are nearer than this share of the square root of the median area are one corner.
const SAME_CORNER: f64 = 1e-3;

/// What a table of outlines does not say about itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OutlineOptions {
    /// Units and directions.
    pub scale: ImageScale,
    /// Columns that are not to be recognised automatically; `track` is the number of the cell.
    pub columns: ColumnNames,
}

/// Imports a table with a row for each corner of each cell: cell, x, y and perhaps frame. Rows of a cell follow each other around its
/// outline, in either sense. Cells of one number are one cell in all frames. Two cells touch along a side that both have.
///
/// # Errors
/// [`Error::File`] and [`Error::Table`], the latter with the line; [`Error::Image`] for a cell without an area or a frame with fewer than
/// three cells; [`Error::Setting`] for options out of range.
pub fn import_outlines(path: &Path, options: &OutlineOptions) -> Result<ShapeImport, Error> {
    options.scale.begin(Boundary::Open)?;
    let (bytes, record) = read_input(path)?;
    let table = read_spots(path, &bytes, Layout::Outlines, &options.columns)?;
    let mut notes = table.notes.clone();
    let (scale, mut dataset) = table.stated.settle(&options.scale, &mut notes).begin(Boundary::Open)?;
    dataset.inputs.push(record);
    let failure = |fault| Error::Table { path: path.to_path_buf(), line: None, fault };
    let (first, frames) = frame_span(table.spots.iter().map(|spot| spot.frame)).map_err(failure)?;
    let numbers: BTreeSet<i64> = table.spots.iter().map(|spot| spot.track).collect();
    let tracks: BTreeMap<i64, usize> = numbers.into_iter().zip(0..).collect();
    let mut corners: Vec<BTreeMap<i64, Vec<Vector<f64>>>> = vec![BTreeMap::new(); frames];
    for spot in &table.spots {
        let cells = &mut corners[(spot.frame - first) as usize];
        cells.entry(spot.track).or_default().push(Vector::new(spot.x, spot.y));
    }
    let mut summary = ShapeSummary::default();
    let mut seen = Vec::with_capacity(frames);
    for (index, cells) in corners.into_iter().enumerate() {
        if cells.is_empty() {
            return Err(image_error(path, ImageFault::NoCells { frame: index }));
        }
        summary.outlines += cells.len();
        seen.push(look(path, first + index as i64, cells, &tracks)?);
    }
    let mut import = assemble(path, dataset, scale, seen, summary)?;
    import.notes = notes;
    Ok(import)
}

fn look(
    path: &Path,
    frame: i64,
    corners: BTreeMap<i64, Vec<Vector<f64>>>,
    tracks: &BTreeMap<i64, usize>,
) -> Result<SeenFrame, Error> {
    let numbers: Vec<i64> = corners.keys().copied().collect();
    let polygons: Vec<Vec<Vector<f64>>> = corners.into_values().collect();
    let mut cells = Vec::with_capacity(numbers.len());
    for (&number, polygon) in numbers.iter().zip(&polygons) {
        let outline = Outline::new(polygon).ok_or_else(|| {
            image_error(path, ImageFault::NoArea { frame, cell: number, corners: polygon.len() })
        })?;
        cells.push(SeenCell {
            number,
            centroid: [outline.centroid.x, outline.centroid.y],
            area: outline.area,
            perimeter: outline.perimeter,
            is_cut: false,
        });
    }
    let mut areas: Vec<f64> = cells.iter().map(|cell| cell.area).collect();
    areas.sort_by(f64::total_cmp);
    let tolerance = SAME_CORNER * areas[areas.len() / 2].sqrt();
    let contacts = outline_contacts(&polygons, tolerance);
    let interfaces = outline_interfaces(&polygons, tolerance);
    let sides = polygons
        .iter()
        .flat_map(|polygon| (0..polygon.len()).map(|k| [polygon[k], polygon[(k + 1) % polygon.len()]]));
    Ok(SeenFrame {
        contacts: contacts.into_iter().map(|pair| pair.map(|cell| numbers[cell])).collect(),
        outlines: sides.map(|side| side.map(|r| [r.x, r.y])).collect(),
        interfaces,
        tracks: numbers.iter().map(|number| (*number, tracks[number])).collect(),
        cells,
    })
}
