//! Cells with their true outlines: what label images and outlines have in common.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ndarray::{Array2, Array3};

use voronudge_geometry::{Interface, Vector};

use crate::dataset::DataSet;
use crate::error::{Error, ImageFault, image_error};
use crate::memory::SIZE_LIMIT;
use crate::note::Note;
use crate::output::OutputDirectory;
use crate::validate::ArrayNames;

/// The fewest cells with a tessellation.
const FEWEST_CELLS: usize = 3;

/// A data set with the true shapes of its cells.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeImport {
    /// The data set; positions are centroids.
    pub dataset: DataSet,
    /// (frames, cells): the number of each cell in the file, −1 where it is absent.
    pub numbers: Array2<i64>,
    /// (frames, cells): true areas in units of length squared; NaN where a cell is absent.
    pub areas: Array2<f64>,
    /// (frames, cells): true perimeters in units of length; NaN where a cell is absent.
    pub perimeters: Array2<f64>,
    /// What else is known of each frame.
    pub frames: Vec<ShapeFrame>,
    /// The counts to report.
    pub summary: ShapeSummary,
    /// What was read, guessed and doubted.
    pub notes: Vec<Note>,
}

/// True contacts and outlines of one frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ShapeFrame {
    /// Pairs of cells that touch, indices along the axis of cells, the lower first.
    pub contacts: BTreeSet<[usize; 2]>,
    /// Cells that may go on beyond the image.
    pub cut: BTreeSet<usize>,
    /// The outlines as straight segments in units of length, y up.
    pub outlines: Vec<[[f64; 2]; 2]>,
    /// Where cells touch, indices along the axis of cells, in units of length, y up.
    pub interfaces: Vec<Interface>,
}

/// What was found and left out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ShapeSummary {
    /// Outlines, over all frames.
    pub outlines: usize,
    /// Cells at the border of the image, over all frames, kept or not.
    pub at_border: usize,
    /// Cells in more than one piece, over all frames.
    pub in_pieces: usize,
}

/// A cell of one frame, in units of the file, y as in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SeenCell {
    pub number: i64,
    pub centroid: [f64; 2],
    pub area: f64,
    pub perimeter: f64,
    pub is_cut: bool,
}

/// The cells of one frame with what belongs to them, in units of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SeenFrame {
    pub cells: Vec<SeenCell>,
    /// Pairs of numbers.
    pub contacts: BTreeSet<[i64; 2]>,
    pub outlines: Vec<[[f64; 2]; 2]>,
    /// Where cells touch; indices of `cells`.
    pub interfaces: Vec<Interface>,
    /// Index along the axis of cells of each number.
    pub tracks: BTreeMap<i64, usize>,
}

/// Puts frames together; `scale` is the length of the file's unit.
pub(crate) fn assemble(
    path: &Path,
    mut dataset: DataSet,
    scale: f64,
    seen: Vec<SeenFrame>,
    summary: ShapeSummary,
) -> Result<ShapeImport, Error> {
    for (frame, one) in seen.iter().enumerate() {
        let found = one.cells.len();
        if found < FEWEST_CELLS {
            let needed = FEWEST_CELLS;
            return Err(image_error(path, ImageFault::TooFewCells { frame, found, needed }));
        }
    }
    let frames = seen.len();
    let cells = seen.iter().flat_map(|frame| frame.tracks.values()).max().map_or(0, |last| last + 1);
    check_size(path, frames, cells)?;
    let mut import = ShapeImport {
        numbers: Array2::from_elem((frames, cells), -1),
        areas: Array2::from_elem((frames, cells), f64::NAN),
        perimeters: Array2::from_elem((frames, cells), f64::NAN),
        frames: Vec::with_capacity(frames),
        summary,
        notes: Vec::new(),
        dataset: DataSet { positions: Array3::from_elem((frames, cells, 2), f64::NAN), ..dataset.clone() },
    };
    dataset = import.dataset;
    for (index, frame) in seen.into_iter().enumerate() {
        let mut shape = ShapeFrame::default();
        for cell in &frame.cells {
            let Some(&track) = frame.tracks.get(&cell.number) else { continue };
            let at = (index, track);
            import.numbers[at] = cell.number;
            import.areas[at] = cell.area * scale * scale;
            import.perimeters[at] = cell.perimeter * scale;
            dataset.positions[(index, track, 0)] = cell.centroid[0] * scale;
            dataset.positions[(index, track, 1)] = cell.centroid[1] * scale;
            if cell.is_cut {
                shape.cut.insert(track);
            }
        }
        for [a, b] in &frame.contacts {
            if let (Some(&a), Some(&b)) = (frame.tracks.get(a), frame.tracks.get(b)) {
                shape.contacts.insert([a.min(b), a.max(b)]);
            }
        }
        let up = match dataset.y_axis {
            crate::YAxis::Up => 1.0,
            crate::YAxis::Down => -1.0,
        };
        let place = |[x, y]: [f64; 2]| [x * scale, up * y * scale];
        let turned = |r: Vector<f64>| Vector::from(place([r.x, r.y]));
        let track = |cell: usize| frame.tracks.get(&frame.cells[cell].number).copied();
        shape.interfaces = frame
            .interfaces
            .iter()
            .filter_map(|line| {
                let [Some(a), Some(b)] = line.cells.map(track) else { return None };
                let (middle, extent) = (turned(line.middle), turned(line.extent));
                Some(Interface { cells: [a, b], length: line.length * scale, middle, extent })
            })
            .collect();
        shape.outlines = frame.outlines.iter().map(|segment| segment.map(place)).collect();
        import.frames.push(shape);
    }
    dataset.check_arrays(&ArrayNames::of_one(path))?;
    dataset.y_axis.turn(&mut dataset.positions);
    import.dataset = dataset;
    Ok(import)
}

/// That positions of this shape are not absurdly many.
pub(crate) fn check_size(path: &Path, frames: usize, cells: usize) -> Result<(), Error> {
    let bytes = 16 * frames as u64 * cells as u64;
    if bytes > SIZE_LIMIT {
        let fault = ImageFault::TooManyCells { frames, cells, bytes, limit: SIZE_LIMIT };
        return Err(image_error(path, fault));
    }
    Ok(())
}

impl ShapeImport {
    /// Stages the data set, `true_areas.npy`, `true_perimeters.npy` and `cell_numbers.npy`, each (frames, cells).
    ///
    /// # Errors
    /// As [`DataSet::save`].
    pub fn save(&self, out: &mut OutputDirectory) -> Result<(), Error> {
        self.dataset.save(out)?;
        out.write_array("true_areas.npy", self.areas.view())?;
        out.write_array("true_perimeters.npy", self.perimeters.view())?;
        out.write_integers("cell_numbers.npy", self.numbers.view())
    }
}
