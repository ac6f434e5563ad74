//! Importing flow fields: dense displacements of pixels, and tables of vectors.

mod nodes;
mod pixels;
mod units;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use ndarray::{Array4, ArrayView4, Axis, concatenate};

use crate::array::parse_field;
use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, GridFault, SettingFault};
use crate::flow::{FlowField, FlowNames, check_values, grid_error};
use crate::image_scale::{ImageScale, describe};
use crate::input::read_input;
use crate::note::Note;
use crate::output::OutputDirectory;
use crate::positive::positive;
use crate::save::write_flow;
use crate::settings::render;
use crate::source::read_vectors;
use crate::table::{FlowColumnNames, VectorTable, read_table};
use crate::validate::ArrayNames;
use nodes::arrange;
use pixels::{Squares, average};
use units::take_units;

/// What the files of a flow do not say about themselves. The default leaves everything open.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FlowOptions {
    /// Columns of tables that are not to be recognised automatically.
    pub columns: FlowColumnNames,
    /// Length of a pixel, by which coordinates and displacements are multiplied, time between frames, by which displacements are divided, and so
    /// on. Units of tables that are not scaled are those of their headers.
    pub scale: ImageScale,
    /// Side of the squares that displacements of pixels are averaged over, in the unit of length;
    /// default: one pixel, that is, no averaging.
    pub grid_spacing: Option<f64>,
    /// What is around the cells; default open.
    pub boundary: Option<Boundary>,
    /// Positions of the cells, `.npy`, in the unit of length and with y in the direction of
    /// `y_axis`.
    pub positions: Option<PathBuf>,
}

/// An imported flow field, with positions if they were given.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowImport {
    /// The data set with its flow field. Without positions it has no cells, and
    /// [`DataSet::check`] refuses it; [`FlowImport::save`] writes it nevertheless.
    pub dataset: DataSet,
    /// The counts to report.
    pub summary: FlowSummary,
    /// What was read, guessed and doubted.
    pub notes: Vec<Note>,
}

/// What the flow field is like.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowSummary {
    /// Frames.
    pub frames: usize,
    /// The number of the first frame in a table with a column of frames, else 0.
    pub first_frame: i64,
    /// Grid points along y.
    pub rows: usize,
    /// Grid points along x.
    pub columns: usize,
    /// Distance of grid points along x and y in the unit of length.
    pub spacing: [f64; 2],
    /// Grid points without a velocity, summed over frames.
    pub missing: usize,
    /// The unit of displacements that the header of a table states.
    pub stated_unit: Option<String>,
}

/// Imports the displacements of an optical flow or of particle image velocimetry, in pixels per
/// frame.
///
/// Either `.npy` arrays with a displacement for each pixel, (ny, nx, 2) or (frames, ny, nx, 2),
/// as OpenCV computes them; pixel p takes up [p, p + 1) times the size of a pixel. Or tables with
/// columns x, y, u, v, in any order of columns and rows, of points on a rectangular grid. Several
/// files are one frame each.
///
/// # Errors
/// [`Error::File`], [`Error::Format`], [`Error::Shape`] and [`Error::Table`], the latter with the
/// line, for files that are not what they should be; [`Error::Grid`] for a field or a grid that
/// cannot be used; [`Error::Setting`] for options out of range; [`Error::Value`] for positions.
pub fn import_flow(files: &[PathBuf], options: &FlowOptions) -> Result<FlowImport, Error> {
    let scale = &options.scale;
    let pixel = scale.pixel_size.unwrap_or(1.0);
    positive("pixel_size", pixel).map_err(Error::Setting)?;
    let side = options.grid_spacing.unwrap_or(pixel);
    positive("grid_spacing", side).map_err(Error::Setting)?;
    let mut dataset = describe(
        options.boundary.unwrap_or(Boundary::Open),
        scale.frame_interval,
        scale.y_axis,
        scale.length_unit.as_deref(),
        scale.time_unit.as_deref(),
    );
    dataset.check_settings().map_err(Error::Setting)?;

    let (mut arrays, mut tables) = (Arrays::default(), Vec::new());
    for path in files {
        let (bytes, record) = read_input(path)?;
        dataset.inputs.push(record);
        let failure = |fault| Err(grid_error(path, fault));
        match is_array(path, &bytes) {
            true if !tables.is_empty() => return failure(GridFault::OtherKind),
            true if options.columns != FlowColumnNames::default() => return failure(GridFault::NoColumns),
            true => arrays.take(path, parse_field(path, &bytes)?, pixel, side, files.len())?,
            false if !arrays.frames.is_empty() => return failure(GridFault::OtherKind),
            false if options.grid_spacing.is_some() => return failure(GridFault::NoPixels),
            false => tables.push((path.clone(), read_table(path, &bytes, &options.columns)?)),
        }
    }
    let Some(first) = files.first() else {
        return Err(Error::Setting(SettingFault::MissingFlow));
    };
    let (mut flow, first_frame) = match tables.as_slice() {
        [] => (arrays.assemble(first)?, 0),
        tables => scaled(tables, pixel)?,
    };
    flow.velocities *= pixel / dataset.frame_interval;

    let names = FlowNames { field: first, x: first, y: first };
    flow.check(names, dataset.boundary)?;
    let (frames, rows, columns, _) = flow.velocities.dim();
    let summary = FlowSummary {
        frames,
        first_frame,
        rows,
        columns,
        spacing: flow.spacing(),
        missing: flow.missing(),
        stated_unit: tables.iter().find_map(|(_, table)| table.unit.clone()),
    };
    dataset.flow = Some(flow);
    if let Some(path) = &options.positions {
        dataset.positions = read_vectors(path, &mut dataset.inputs)?;
        dataset.check_arrays(&ArrayNames { flow: names, ..ArrayNames::of_one(path) })?;
    }
    dataset.y_axis.turn(&mut dataset.positions);
    if let Some(flow) = &mut dataset.flow {
        flow.turn(dataset.y_axis);
    }
    let notes = tables.first().map(|(_, table)| take_units(table, options, &mut dataset)).unwrap_or_default();
    Ok(FlowImport { dataset, summary, notes })
}

impl FlowImport {
    /// Whether positions were given, so that what is saved is a whole data set.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.dataset.cells() > 0
    }

    /// Stages the data set; without positions only the flow field and `dataset.toml`, to which
    /// `positions.npy` must be added.
    ///
    /// # Errors
    /// As [`DataSet::save`].
    pub fn save(&self, out: &mut OutputDirectory) -> Result<(), Error> {
        match &self.dataset.flow {
            Some(flow) if !self.is_complete() => {
                flow.check(FlowNames::in_folder(), self.dataset.boundary)?;
                write_flow(out, flow, self.dataset.y_axis)?;
                out.write_text("dataset.toml", &render(&self.dataset))
            }
            _ => self.dataset.save(out),
        }
    }
}

/// Averaged displacements of pixels, file by file.
#[derive(Default)]
struct Arrays {
    frames: Vec<Array4<f64>>,
    /// Rows and columns of pixels of the first file, and the squares they are averaged over.
    grid: Option<([usize; 2], Squares, Squares)>,
}

impl Arrays {
    /// Averages one file; of several files each must be one frame of the same size.
    fn take(
        &mut self,
        path: &Path,
        dense: Array4<f64>,
        pixel: f64,
        side: f64,
        files: usize,
    ) -> Result<(), Error> {
        let (frames, ny, nx, _) = dense.dim();
        if files > 1 && frames > 1 {
            return Err(grid_error(path, GridFault::SeveralFrames { frames }));
        }
        check_values(path, &dense)?;
        let (size, rows, columns) = match &mut self.grid {
            Some(grid) => grid,
            none => none.insert((
                [ny, nx],
                Squares::cover(path, 'y', ny, pixel, side)?,
                Squares::cover(path, 'x', nx, pixel, side)?,
            )),
        };
        if *size != [ny, nx] {
            return Err(grid_error(path, GridFault::OtherSize { found: [ny, nx], expected: *size }));
        }
        self.frames.push(average(&dense, rows, columns));
        Ok(())
    }

    /// All frames one after another, in pixels per frame; `first` is the first file.
    fn assemble(&self, first: &Path) -> Result<FlowField, Error> {
        let views: Vec<ArrayView4<'_, f64>> = self.frames.iter().map(|frames| frames.view()).collect();
        let (Some((_, rows, columns)), Ok(velocities)) = (&self.grid, concatenate(Axis(0), &views)) else {
            return Err(grid_error(first, GridFault::TooFew { axis: 'x', found: 0 }));
        };
        Ok(FlowField { velocities, x: columns.centres(), y: rows.centres() })
    }
}

/// The field of tables with coordinates in the unit of length, displacements as they are; and the
/// number of its first frame.
fn scaled(tables: &[(PathBuf, VectorTable)], pixel: f64) -> Result<(FlowField, i64), Error> {
    let arranged = arrange(tables)?;
    let mut flow = arranged.flow;
    flow.x.iter_mut().chain(&mut flow.y).for_each(|coordinate| *coordinate *= pixel);
    Ok((flow, arranged.first_frame))
}

/// Whether a file is, or by its name should be, an array rather than a table.
fn is_array(path: &Path, bytes: &[u8]) -> bool {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default().to_lowercase();
    bytes.starts_with(b"\x93NUMPY") || [".npy", ".npz", ".npy.gz"].iter().any(|end| name.ends_with(end))
}
