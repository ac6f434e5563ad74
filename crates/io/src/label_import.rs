//! Importing label images: every pixel carries the number of its cell, or zero.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ndarray::Axis;
use voronudge_geometry::Vector;
use voronudge_segmentation::{Mask, link_overlapping};

use crate::boundary::Boundary;
use crate::error::{Error, ImageFault, ShapeFault, image_error};
use crate::image::{Wanted, parse_labels};
use crate::image_scale::ImageScale;
use crate::series::read_images;
use crate::shapes::{SeenCell, SeenFrame, ShapeImport, ShapeSummary, assemble};

/// How cells of different frames are taken for one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LabelLinking {
    /// Not at all: each frame has cells of its own.
    #[default]
    Separate,
    /// The same label is the same cell.
    SameLabel,
    /// Cells that share most pixels with each other from one frame to the next.
    Overlap,
}

/// What becomes of cells at the border of the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BorderCells {
    /// They are cells, but their shapes are not compared.
    #[default]
    Kept,
    /// They are background.
    LeftOut,
}

/// What a label image does not say about itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LabelOptions {
    /// Units and directions.
    pub scale: ImageScale,
    /// Cells touch across at most so many pixels of background, from side to side.
    pub gap: usize,
    /// Which cells of different frames are one.
    pub linking: LabelLinking,
    /// Cells at the border of the image.
    pub border: BorderCells,
}

/// Imports label images of one file, or of a folder: [`import_label_series`].
///
/// # Errors
/// As [`import_label_series`].
pub fn import_labels(path: &Path, options: &LabelOptions) -> Result<ShapeImport, Error> {
    import_label_series(&[path.to_path_buf()], options)
}

/// Imports label images, `.npy` or TIFF of one frame or several, or PNG: centroids, areas, perimeters and contacts. Several files, and those
/// of a folder, are frames in the natural order of the numbers in their names.
///
/// Pixel size, frame interval and units are those of ImageJ's header or of OME-TIFF where the options do not say otherwise.
/// Pixel (row, column) takes up the square from (column, row) to (column + 1, row + 1) pixels. Areas count pixels; the perimeter is
/// that of [`Mask::cells`]. Cells are numbered along the axis of cells in the order of their labels, frame by frame.
///
/// # Errors
/// [`Error::File`]; [`Error::Format`], [`Error::Shape`] and [`Error::Image`] for a file that is no label image, for frames with fewer
/// than three cells, and for sizes that do not fit in memory; [`Error::Setting`] for options out of range.
pub fn import_label_series(paths: &[PathBuf], options: &LabelOptions) -> Result<ShapeImport, Error> {
    options.scale.begin(Boundary::Open)?;
    let stack = read_images(paths, Wanted::Labels, parse_labels)?;
    let mut notes = stack.notes.clone();
    let (scale, mut dataset) = stack.stated.settle(&options.scale, &mut notes).begin(Boundary::Open)?;
    dataset.inputs.extend(stack.inputs.iter().cloned());
    let (frames, rows, columns) = stack.pixels.dim();
    let mut summary = ShapeSummary::default();
    let mut seen: Vec<SeenFrame> = Vec::with_capacity(frames);
    let mut before: Option<Vec<i64>> = None;
    let mut tracks = Tracks::default();
    for (index, frame) in stack.pixels.axis_iter(Axis(0)).enumerate() {
        let (path, page) = stack.location(index);
        let pixels: Vec<i64> = frame.iter().copied().collect();
        let mask = Mask::new(&pixels, [columns, rows]).map_err(|_| {
            let found = vec![frames, rows, columns];
            Error::Shape { path: path.to_path_buf(), fault: ShapeFault::Nothing { found, axis: "pixels" } }
        })?;
        if pixels.iter().all(|&label| label == 0) {
            return Err(image_error(path, ImageFault::NoCells { frame: page }));
        }
        let mut one = look(&mask, options, &mut summary);
        let links = match (&before, options.linking) {
            (Some(before), LabelLinking::Overlap) => link_overlapping(before, &pixels).unwrap_or_default(),
            _ => BTreeMap::new(),
        };
        let previous = seen.last().map(|frame| &frame.tracks);
        one.tracks = tracks.of(&one, options.linking, previous, &links);
        seen.push(one);
        before = Some(pixels);
    }
    let mut import = assemble(stack.name(), dataset, scale, seen, summary)?;
    import.notes = notes;
    if options.border == BorderCells::Kept {
        import.dataset.see_within_image([columns, rows].map(|pixels| pixels as f64 * scale));
    }
    Ok(import)
}

fn look(mask: &Mask<'_>, options: &LabelOptions, summary: &mut ShapeSummary) -> SeenFrame {
    let mut cells = mask.cells();
    summary.outlines += cells.len();
    summary.at_border += cells.iter().filter(|cell| cell.at_border).count();
    summary.in_pieces += cells.iter().filter(|cell| cell.pieces > 1).count();
    if options.border == BorderCells::LeftOut {
        cells.retain(|cell| !cell.at_border);
    }
    // By ascending label.
    let index = |label| cells.binary_search_by_key(&label, |cell| cell.label).ok();
    let place = |r: Vector<f64>| [r.x, r.y];
    SeenFrame {
        cells: cells
            .iter()
            .map(|cell| SeenCell {
                number: cell.label,
                centroid: place(cell.centroid),
                area: cell.area,
                perimeter: cell.perimeter,
                is_cut: cell.at_border,
            })
            .collect(),
        contacts: mask.contacts(options.gap),
        interfaces: mask.interfaces(options.gap, index),
        outlines: mask.outlines().into_iter().map(|segment| segment.map(place)).collect(),
        tracks: BTreeMap::new(),
    }
}

/// Numbers given out along the axis of cells.
#[derive(Default)]
struct Tracks {
    given: usize,
    of_label: BTreeMap<i64, usize>,
}

impl Tracks {
    fn of(
        &mut self,
        frame: &SeenFrame,
        linking: LabelLinking,
        previous: Option<&BTreeMap<i64, usize>>,
        links: &BTreeMap<i64, i64>,
    ) -> BTreeMap<i64, usize> {
        let came_from: BTreeMap<i64, i64> = links.iter().map(|(&from, &to)| (to, from)).collect();
        let mut tracks = BTreeMap::new();
        for cell in &frame.cells {
            let known = match linking {
                LabelLinking::Separate => None,
                LabelLinking::SameLabel => self.of_label.get(&cell.number).copied(),
                LabelLinking::Overlap => came_from
                    .get(&cell.number)
                    .and_then(|from| previous.and_then(|tracks| tracks.get(from)).copied()),
            };
            let track = known.unwrap_or_else(|| {
                self.given += 1;
                self.given - 1
            });
            self.of_label.insert(cell.number, track);
            tracks.insert(cell.number, track);
        }
        tracks
    }
}
