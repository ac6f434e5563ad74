//! What is in a file or a folder, without importing it.

mod arrays;
mod tables;

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

use ndarray::Axis;

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, ImageFault};
use crate::image::{Wanted, is_image, parse_field_images, parse_labels};
use crate::image_scale::ImageScale;
use crate::input::read_input;
use crate::napari;
use crate::note::Note;
use crate::series::{Stack, read_images};
use crate::source::Source;
use crate::tracks::{ImportOptions, import_tracks};
use crate::zarr::is_geff;

/// What a file or a folder is taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum InputKind {
    /// A folder with `positions.npy`.
    DataSet,
    /// `positions.npy` by itself, or another array of plane vectors.
    Positions,
    /// An array of vectors on a grid.
    FlowArray,
    /// A table of vectors on a grid.
    FlowTable,
    /// A table or an array of tracks.
    Tracks,
    /// What TrackMate saves or exports.
    TrackMate,
    /// A table or an array of points without tracks.
    Points,
    /// A table of corners of cells.
    Outlines,
    /// Label images.
    Labels,
    /// Images of something else than labels.
    Field,
}

/// What is in a file or a folder. What does not apply is `None` or empty.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// What it is taken for.
    pub kind: InputKind,
    /// Shape of its array, or (frames, rows, columns) of its images.
    pub shape: Option<Vec<usize>>,
    /// Frames.
    pub frames: Option<usize>,
    /// Cells: those of the axis of cells, or different labels.
    pub cells: Option<usize>,
    /// Cells in each frame.
    pub present: Vec<usize>,
    /// Smallest x and y and largest x and y of cells, in `length_unit`, y as in the files.
    pub extent: Option<[f64; 4]>,
    /// Length of a pixel.
    pub pixel_size: Option<f64>,
    /// Unit of length.
    pub length_unit: Option<String>,
    /// Time between frames.
    pub frame_interval: Option<f64>,
    /// Unit of time.
    pub time_unit: Option<String>,
    /// What is around the cells, for a data set.
    pub boundary: Option<Boundary>,
    /// The direction of y in the files.
    pub y_axis: Option<crate::YAxis>,
    /// The files that were read.
    pub files: Vec<PathBuf>,
    /// What was read, guessed and doubted.
    pub notes: Vec<Note>,
}

impl InputKind {
    /// The words of the command that takes it.
    #[must_use]
    pub fn command(self) -> &'static str {
        match self {
            Self::DataSet => "infer",
            Self::Positions => "infer --open --positions",
            Self::FlowArray | Self::FlowTable => "import flow",
            Self::Tracks => "import tracks",
            Self::TrackMate => "import trackmate",
            Self::Points => "import points",
            Self::Outlines => "import outlines",
            Self::Labels => "import labels",
            Self::Field => "import field",
        }
    }
}

impl fmt::Display for InputKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DataSet => "data set",
            Self::Positions => "array of positions",
            Self::FlowArray => "array of displacements or velocities on a grid",
            Self::FlowTable => "table of vectors on a grid",
            Self::Tracks => "tracks of cells",
            Self::TrackMate => "tracks of cells, from TrackMate",
            Self::Points => "places of cells without tracks",
            Self::Outlines => "outlines of cells",
            Self::Labels => "label images",
            Self::Field => "images that are no labels",
        })
    }
}

impl Inspection {
    fn of(kind: InputKind) -> Self {
        Self {
            kind,
            shape: None,
            frames: None,
            cells: None,
            present: Vec::new(),
            extent: None,
            pixel_size: None,
            length_unit: None,
            frame_interval: None,
            time_unit: None,
            boundary: None,
            y_axis: None,
            files: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Points that were not followed: how many cells there are is not known.
    fn of_points(data: &DataSet, notes: Vec<Note>) -> Self {
        Self { shape: None, cells: None, ..Self::of_data(InputKind::Points, data, notes) }
    }

    fn of_data(kind: InputKind, data: &DataSet, notes: Vec<Note>) -> Self {
        let y = if data.y_axis == crate::YAxis::Down { -1.0 } else { 1.0 };
        let mut extent: Option<[f64; 4]> = None;
        let mut present = Vec::with_capacity(data.frames());
        for frame in data.positions.axis_iter(Axis(0)) {
            let mut count = 0;
            for place in frame.axis_iter(Axis(0)).filter(|place| place[0].is_finite()) {
                let (x, y) = (place[0], y * place[1]);
                let [x0, y0, x1, y1] = extent.unwrap_or([x, y, x, y]);
                extent = Some([x0.min(x), y0.min(y), x1.max(x), y1.max(y)]);
                count += 1;
            }
            present.push(count);
        }
        Self {
            shape: Some(data.positions.shape().to_vec()),
            frames: Some(data.frames()),
            cells: Some(data.cells()),
            present,
            extent,
            length_unit: Some(data.length_unit.clone()),
            frame_interval: Some(data.frame_interval),
            time_unit: Some(data.time_unit.clone()),
            y_axis: Some(data.y_axis),
            boundary: (kind == InputKind::DataSet).then_some(data.boundary),
            files: data.inputs.iter().map(|input| input.path.clone()).collect(),
            notes,
            ..Self::of(kind)
        }
    }
}

/// Looks at a file of any kind that is read, a folder of images, or a data set.
///
/// # Errors
/// What reading it as what it looks like would give: [`Error::File`], [`Error::Table`], [`Error::Image`] and others.
pub fn inspect(path: &Path) -> Result<Inspection, Error> {
    if path.is_dir() {
        if path.join("positions.npy").exists() || path.join("dataset.toml").exists() {
            let data = Source::folder(path).load()?;
            return Ok(Inspection::of_data(InputKind::DataSet, &data, Vec::new()));
        }
        if is_geff(path) {
            let found = import_tracks(path, &ImportOptions::default())?;
            return Ok(Inspection::of_data(InputKind::Tracks, &found.dataset, found.notes));
        }
        return of_images(path);
    }
    let (bytes, _) = read_input(path)?;
    if bytes.starts_with(napari::SIGNATURE) {
        if let Some(found) = arrays::of_array(path, &bytes)? {
            return Ok(found);
        }
    } else if !is_image(&bytes) {
        return tables::of_table(path, &bytes);
    }
    of_images(path)
}

/// Label images if all are integers in grey, else images of something else.
fn of_images(path: &Path) -> Result<Inspection, Error> {
    let paths = [path.to_path_buf()];
    match read_images(&paths, Wanted::Labels, parse_labels) {
        Ok(stack) => of_labels(&stack),
        Err(error) => {
            let is_field = matches!(
                error,
                Error::Image { fault: ImageFault::RealLabels { .. } | ImageFault::NegativeLabel { .. }, .. }
            );
            if !is_field {
                return Err(error);
            }
            of_stack(InputKind::Field, &read_images(&paths, Wanted::Field, parse_field_images)?)
        }
    }
}

fn of_labels(stack: &Stack<i64>) -> Result<Inspection, Error> {
    let mut all: BTreeSet<i64> = BTreeSet::new();
    let mut present = Vec::new();
    for frame in stack.pixels.axis_iter(Axis(0)) {
        let own: BTreeSet<i64> = frame.iter().copied().filter(|label| *label != 0).collect();
        present.push(own.len());
        all.extend(own);
    }
    Ok(Inspection { cells: Some(all.len()), present, ..of_stack(InputKind::Labels, stack)? })
}

fn of_stack<T>(kind: InputKind, stack: &Stack<T>) -> Result<Inspection, Error> {
    let mut notes = stack.notes.clone();
    let settled = stack.stated.settle(&ImageScale::default(), &mut notes);
    let (_, data) = settled.begin(Boundary::Open)?;
    let files: Vec<PathBuf> = stack.inputs.iter().map(|input| input.path.clone()).collect();
    Ok(Inspection {
        shape: Some(stack.pixels.shape().to_vec()),
        frames: Some(stack.pixels.dim().0),
        pixel_size: settled.pixel_size,
        length_unit: Some(data.length_unit),
        frame_interval: Some(data.frame_interval),
        time_unit: Some(data.time_unit),
        files,
        notes,
        ..Inspection::of(kind)
    })
}
