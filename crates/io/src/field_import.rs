//! Importing a field: cells are its maxima or minima.

use std::path::{Path, PathBuf};

use ndarray::{Array2, Array3, ArrayView2, Axis};
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_segmentation::{Edge, ExtremumKind, ExtremumSearch, extrema, smooth};

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, ImageFault, SettingFault, image_error};
use crate::image::{Wanted, parse_field_images};
use crate::image_scale::ImageScale;
use crate::linking::{Follower, Place, PlaceLinking};
use crate::note::Note;
use crate::positive::positive;
use crate::series::read_images;
use crate::shapes::check_size;
use crate::validate::ArrayNames;

/// Prominence asked for by default, as a share of the range of the smoothed field.
const PROMINENCE: f64 = 0.1;
/// The fewest cells with a tessellation.
const FEWEST_CELLS: usize = 3;

/// Which extrema are cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WantedExtrema {
    /// Maxima.
    #[default]
    Maxima,
    /// Minima.
    Minima,
    /// Both; maxima get the label 0, minima the label 1.
    Both,
}

/// What is taken for a cell, and what a field does not say about itself. The default leaves everything open.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FieldOptions {
    /// Units and directions.
    pub scale: ImageScale,
    /// Which extrema.
    pub extrema: WantedExtrema,
    /// Standard deviation, in units of length, of the Gaussian average that is taken first; 0 for none.
    pub smoothing: f64,
    /// Least prominence in units of the field; default a tenth of the range of the smoothed field, frame by frame.
    pub prominence: Option<f64>,
    /// Least distance of two extrema of a kind, in units of length; 0 for none.
    pub distance: f64,
    /// Whether the field repeats.
    pub edge: Edge,
    /// Which cells of different frames are one.
    pub linking: PlaceLinking,
}

/// An imported data set, with the height and prominence of each extremum.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldImport {
    /// The data set; with both kinds of extrema it has labels.
    pub dataset: DataSet,
    /// (frames, cells): the smoothed field at the extremum; NaN where a cell is absent.
    pub heights: Array2<f64>,
    /// (frames, cells): its prominence.
    pub prominences: Array2<f64>,
    /// Extrema in each frame.
    pub counts: Vec<usize>,
    /// Cells linked to one of the frame before, over all frames.
    pub linked: usize,
    /// The first frame (rows, columns), as read.
    pub first: Array2<f64>,
    /// Length of a pixel.
    pub pixel_size: f64,
    /// What was read, guessed and doubted.
    pub notes: Vec<Note>,
}

/// An extremum on its way into a data set.
struct Found {
    position: Vector<f64>,
    value: f64,
    prominence: f64,
    label: i64,
    track: usize,
}

/// Imports extrema of a field, `.npy` or TIFF of one frame or several, or grey PNG.
///
/// Pixel (row, column) has its centre at (column + ½, row + ½) pixels. See [`extrema`] for what counts and [`voronudge_segmentation::link_nearest`] for how cells
/// are followed.
///
/// # Errors
/// [`Error::File`]; [`Error::Format`], [`Error::Shape`] and [`Error::Image`] for a file that is no field, or frames with fewer than three
/// extrema; [`Error::Setting`] for options out of range.
pub fn import_field(path: &Path, options: &FieldOptions) -> Result<FieldImport, Error> {
    import_field_series(&[path.to_path_buf()], options)
}

/// The same of several files, or of a folder: frames in the natural order of the numbers in their names.
///
/// # Errors
/// As [`import_field`].
pub fn import_field_series(paths: &[PathBuf], options: &FieldOptions) -> Result<FieldImport, Error> {
    for (key, value) in [("smoothing", options.smoothing), ("distance", options.distance)] {
        if value != 0.0 {
            positive(key, value).map_err(Error::Setting)?;
        }
    }
    if let Some(prominence) = options.prominence {
        positive("prominence", prominence).map_err(Error::Setting)?;
    }
    if let PlaceLinking::Nearest { limit: Some(limit) } = options.linking {
        positive("link_limit", limit).map_err(Error::Setting)?;
    }
    options.scale.begin(Boundary::Open)?;
    let stack = read_images(paths, Wanted::Field, parse_field_images)?;
    let mut notes = stack.notes.clone();
    let (pixel, mut dataset) = stack.stated.settle(&options.scale, &mut notes).begin(Boundary::Open)?;
    dataset.inputs.extend(stack.inputs.iter().cloned());
    let (path, field) = (stack.name(), &stack.pixels);
    let (_, rows, columns) = field.dim();
    let lengths = [columns as f64 * pixel, rows as f64 * pixel];
    if options.smoothing > lengths[0].max(lengths[1]) {
        let fault = SettingFault::BeyondImage { key: "smoothing", value: options.smoothing, size: lengths };
        return Err(Error::Setting(fault));
    }
    let domain = match options.edge {
        Edge::Open => Domain::Open,
        Edge::Periodic => {
            dataset.boundary = Boundary::Periodic { lengths };
            let periodic = PeriodicBox::new(lengths);
            Domain::Periodic(periodic.map_err(|_| {
                Error::Setting(SettingFault::NotPositive { key: "box length", value: lengths[0] })
            })?)
        }
    };
    let mut frames: Vec<Vec<Found>> = Vec::new();
    let mut follower = Follower::new(options.linking, domain);
    for (index, frame) in field.axis_iter(Axis(0)).enumerate() {
        let mut found = find(frame, pixel, options);
        if found.len() < FEWEST_CELLS {
            let (path, frame) = stack.location(index);
            let fault = ImageFault::TooFewCells { frame, found: found.len(), needed: FEWEST_CELLS };
            return Err(image_error(path, fault));
        }
        let spacing = (lengths[0] * lengths[1] / found.len() as f64).sqrt();
        let places: Vec<Place> =
            found.iter().map(|one| Place { position: one.position, kind: one.label }).collect();
        for (one, track) in found.iter_mut().zip(follower.follow(&places, spacing)) {
            one.track = track;
        }
        frames.push(found);
    }
    let Follower { given, linked, .. } = follower;
    check_size(path, frames.len(), given)?;
    let mut import = FieldImport {
        heights: Array2::from_elem((frames.len(), given), f64::NAN),
        prominences: Array2::from_elem((frames.len(), given), f64::NAN),
        counts: frames.iter().map(Vec::len).collect(),
        linked,
        first: field.index_axis(Axis(0), 0).to_owned(),
        pixel_size: pixel,
        notes,
        dataset,
    };
    let mut positions = Array3::from_elem((frames.len(), given, 2), f64::NAN);
    let mut labels = Array2::from_elem((frames.len(), given), -1);
    for (index, found) in frames.iter().enumerate() {
        for one in found {
            let at = (index, one.track);
            (positions[(index, one.track, 0)], positions[(index, one.track, 1)]) =
                (one.position.x, one.position.y);
            import.heights[at] = one.value;
            import.prominences[at] = one.prominence;
            labels[at] = one.label;
        }
    }
    let dataset = &mut import.dataset;
    dataset.positions = positions;
    dataset.labels = (options.extrema == WantedExtrema::Both).then_some(labels);
    dataset.check_arrays(&ArrayNames::of_one(path))?;
    dataset.y_axis.turn(&mut dataset.positions);
    dataset.see_within_image(lengths);
    Ok(import)
}

/// The extrema of a frame in units of length, row by row.
fn find(frame: ArrayView2<'_, f64>, pixel: f64, options: &FieldOptions) -> Vec<Found> {
    let (rows, columns) = frame.dim();
    let size = [columns, rows];
    let values: Vec<f64> = frame.iter().copied().collect();
    let smoothing = options.smoothing / pixel;
    let prominence = options.prominence.unwrap_or_else(|| {
        let smoothed = smooth(&values, size, smoothing, options.edge).unwrap_or_default();
        let low = smoothed.iter().copied().fold(f64::INFINITY, f64::min);
        let high = smoothed.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        PROMINENCE * (high - low)
    });
    let kinds: &[(ExtremumKind, i64)] = match options.extrema {
        WantedExtrema::Maxima => &[(ExtremumKind::Maximum, 0)],
        WantedExtrema::Minima => &[(ExtremumKind::Minimum, 1)],
        WantedExtrema::Both => &[(ExtremumKind::Maximum, 0), (ExtremumKind::Minimum, 1)],
    };
    let mut found = Vec::new();
    for &(kind, label) in kinds {
        let search = ExtremumSearch {
            kind,
            smoothing,
            // A constant field has one plateau without any height, which is no cell.
            prominence: prominence.max(f64::MIN_POSITIVE),
            distance: options.distance / pixel,
            edge: options.edge,
        };
        found.extend(extrema(&values, size, &search).unwrap_or_default().into_iter().map(|extremum| Found {
            position: extremum.position * pixel,
            value: extremum.value,
            prominence: extremum.prominence,
            label,
            track: 0,
        }));
    }
    let key = |one: &Found| ((one.position.y / pixel) as i64, one.position.x);
    found.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
    found
}
