//! From a folder, single files and flags to one checked data set.

use std::fs;
use std::path::{Path, PathBuf};

use ndarray::{Array2, ArrayD, Axis, Ix2};

use crate::array::{parse_field, parse_integers, parse_reals, parse_row, parse_vectors};
use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, FileFault, GridFault, SettingFault, ShapeFault};
use crate::field_of_view::SeenArea;
use crate::flow::{FlowField, FlowNames, grid_error};
use crate::input::{InputFile, file_fault, read_input};
use crate::measurement::{DeclaredWindow, PositionsAre};
use crate::noise::Noise;
use crate::output::OutputFolder;
use crate::settings::Settings;
use crate::validate::ArrayNames;
use crate::y_axis::YAxis;

/// Where a data set comes from. A field that is set wins over the folder and its `dataset.toml`.
///
/// ```no_run
/// use voronudge_io::{Boundary, Source};
/// let source = Source {
///     folder: Some("my-movie".into()),
///     boundary: Some(Boundary::Open),
///     ..Source::default()
/// };
/// let data = source.load()?;
/// println!("{} cells in {} frames", data.cells(), data.frames());
/// # Ok::<(), voronudge_io::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Source {
    /// A folder with `positions.npy` and, each optional, `velocities.npy`, `labels.npy`, `position_errors.npy`,
    /// `dataset.toml`, and `flow.npy` with `flow_x.npy` and `flow_y.npy`.
    pub folder: Option<PathBuf>,
    /// The positions, (cells, 2) or (frames, cells, 2).
    pub positions: Option<PathBuf>,
    /// The velocities, in the shape of the positions.
    pub velocities: Option<PathBuf>,
    /// The labels, (cells,) or (frames, cells), integers.
    pub labels: Option<PathBuf>,
    /// Standard deviation of each coordinate of a cell, (cells,) or (frames, cells).
    pub position_errors: Option<PathBuf>,
    /// Velocities on a grid, (ny, nx, 2) or (frames, ny, nx, 2); needs its coordinates.
    pub flow: Option<PathBuf>,
    /// x of the columns of the grid, (nx,), evenly spaced.
    pub flow_x: Option<PathBuf>,
    /// y of the rows of the grid, (ny,), evenly spaced.
    pub flow_y: Option<PathBuf>,
    /// What is around the cells. There is no default.
    pub boundary: Option<Boundary>,
    /// Time between frames; default 1.
    pub frame_interval: Option<f64>,
    /// Name of the unit of length; default `length`.
    pub length_unit: Option<String>,
    /// Name of the unit of time; default `time`.
    pub time_unit: Option<String>,
    /// The y direction in the files; default up.
    pub y_axis: Option<YAxis>,
    /// Whether positions run on across the periodic boundary; default no.
    pub unwrapped: Option<bool>,
    /// Standard deviation of a position coordinate.
    pub position_noise: Option<Noise>,
    /// Standard deviation of a velocity component.
    pub velocity_noise: Option<Noise>,
    /// Where every cell would have been seen, y as in the files.
    pub field_of_view: Option<SeenArea>,
    /// What of a cell a position is.
    pub positions_are: Option<PositionsAre>,
    /// What a grid point of the flow field stands for. A kind given here puts the width of `dataset.toml` out of force.
    pub window: DeclaredWindow,
}

impl Source {
    /// A folder with a `dataset.toml`, as it stands.
    pub fn folder(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()), ..Self::default() }
    }

    /// Reads and checks the data set.
    ///
    /// The settings are settled first, so that a missing boundary is told before large arrays
    /// are read. With `y_axis` down, y of positions, velocities and the flow field is negated: in
    /// memory y is up, also in a periodic box, where y then lies between −Ly and 0; wrapping is left to
    /// whoever builds the box.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::Format`] and [`Error::Shape`] for files that are not what they
    /// should be; [`Error::Toml`] and [`Error::Setting`] for missing or impossible settings;
    /// [`Error::Value`] and [`Error::Grid`] as listed at [`DataSet::check`], the latter also for a
    /// flow field without its coordinates.
    pub fn load(&self) -> Result<DataSet, Error> {
        if let Some(folder) = &self.folder {
            OutputFolder::settle(folder)?;
        }
        let mut inputs = Vec::new();
        let mut settings = self.read_settings(&mut inputs)?;
        let boundary = match self.boundary {
            Some(boundary) => boundary,
            None => settings.boundary()?.ok_or_else(|| self.missing_boundary())?,
        };
        let field_of_view = settings.field_of_view(self.field_of_view.as_ref(), boundary)?;
        let positions_path = self
            .file(self.positions.as_ref(), "positions.npy")
            .ok_or(Error::Setting(SettingFault::MissingPositions))?;
        let velocities_path = self.optional_file(self.velocities.as_ref(), "velocities.npy");
        let labels_path = self.optional_file(self.labels.as_ref(), "labels.npy");
        let errors_path = self.optional_file(self.position_errors.as_ref(), "position_errors.npy");
        let flow_paths = self.flow_paths()?;

        let mut data = DataSet {
            positions_are: self.positions_are.or(settings.positions_are),
            window: settings.window(self.window, boundary)?,
            box_offset: settings.box_offset,
            walls: settings.walls,
            frame_interval: self.frame_interval.or(settings.frame_interval).unwrap_or(1.0),
            length_unit: first_text(&self.length_unit, settings.length_unit, "length"),
            time_unit: first_text(&self.time_unit, settings.time_unit, "time"),
            y_axis: self.y_axis.or(settings.y_axis).unwrap_or_default(),
            unwrapped: self.unwrapped.or(settings.unwrapped).unwrap_or(false),
            position_noise: self.position_noise.or(settings.position_noise),
            velocity_noise: self.velocity_noise.or(settings.velocity_noise),
            field_of_view,
            inputs,
            ..DataSet::new(ndarray::Array3::zeros((0, 0, 2)), boundary)
        };
        data.check_settings().map_err(Error::Setting)?;

        data.positions = read_vectors(&positions_path, &mut data.inputs)?;
        if let Some(path) = &velocities_path {
            data.velocities = Some(read_vectors(path, &mut data.inputs)?);
        }
        if let Some(paths) = &flow_paths {
            data.flow = Some(paths.read(&mut data.inputs)?);
        }
        if let Some(path) = &labels_path {
            data.labels = Some(read_of_cells(path, &mut data, parse_integers)?);
        }
        if let Some(path) = &errors_path {
            data.position_errors = Some(read_of_cells(path, &mut data, parse_reals)?);
        }
        let unnamed = PathBuf::new();
        data.check_arrays(&ArrayNames {
            positions: &positions_path,
            velocities: velocities_path.as_ref().unwrap_or(&unnamed),
            labels: labels_path.as_ref().unwrap_or(&unnamed),
            position_errors: errors_path.as_ref().unwrap_or(&unnamed),
            flow: flow_paths.as_ref().map_or_else(FlowNames::in_folder, FlowPaths::names),
        })?;

        data.y_axis.turn(&mut data.positions);
        if let Some(area) = &mut data.field_of_view {
            area.turn(data.y_axis);
        }
        data.y_axis.turn_offsets(data.box_offset.as_deref_mut().unwrap_or_default());
        if let Some(velocities) = &mut data.velocities {
            data.y_axis.turn(velocities);
        }
        if let Some(flow) = &mut data.flow {
            flow.turn(data.y_axis);
        }
        Ok(data)
    }

    fn read_settings(&self, inputs: &mut Vec<InputFile>) -> Result<Settings, Error> {
        let Some(folder) = &self.folder else {
            return Ok(Settings::default());
        };
        let failure = |fault| Error::File { path: folder.clone(), fault };
        let metadata = fs::metadata(folder).map_err(|source| failure(file_fault(source)))?;
        if !metadata.is_dir() {
            return Err(failure(FileFault::NotAFolder));
        }
        let path = folder.join("dataset.toml");
        if !is_there(&path) {
            return Ok(Settings::default());
        }
        let (bytes, record) = read_input(&path)?;
        inputs.push(record);
        Settings::parse(&path, &bytes)
    }

    fn missing_boundary(&self) -> Error {
        Error::Setting(SettingFault::MissingBoundary {
            searched: self.folder.as_ref().map(|folder| folder.join("dataset.toml")),
        })
    }

    /// The files of a flow field, where there is one: all three or none.
    fn flow_paths(&self) -> Result<Option<FlowPaths>, Error> {
        let [field, x, y] =
            [(&self.flow, "flow.npy"), (&self.flow_x, "flow_x.npy"), (&self.flow_y, "flow_y.npy")]
                .map(|(given, name)| self.optional_file(given.as_ref(), name));
        let Some(field) = field else {
            return match [('x', x), ('y', y)].into_iter().find_map(|(axis, path)| Some((axis, path?))) {
                Some((axis, path)) => Err(grid_error(&path, GridFault::MissingField { axis })),
                None => Ok(None),
            };
        };
        let missing = |axis, name| {
            let searched = self.folder.as_ref().map(|folder| folder.join(name));
            grid_error(&field, GridFault::MissingCoordinates { axis, searched })
        };
        let x = x.ok_or_else(|| missing('x', "flow_x.npy"))?;
        let y = y.ok_or_else(|| missing('y', "flow_y.npy"))?;
        Ok(Some(FlowPaths { field, x, y }))
    }

    fn file(&self, given: Option<&PathBuf>, name: &str) -> Option<PathBuf> {
        let in_folder = || self.folder.as_ref().map(|folder| folder.join(name));
        given.cloned().or_else(in_folder)
    }

    /// As `file`, but what was not named by the user need not exist.
    fn optional_file(&self, given: Option<&PathBuf>, name: &str) -> Option<PathBuf> {
        let path = self.file(given, name);
        path.filter(|path| given.is_some() || is_there(path))
    }
}

impl DataSet {
    /// Reads a field of vectors in the plane of this data set, of one frame or of any number of them, with the
    /// coordinates of its columns and rows, as [`Source`] reads a flow field. Its files count as inputs.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::Format`], [`Error::Shape`], and [`Error::Grid`] as for a flow field.
    pub fn read_field(&mut self, field: &Path, x: &Path, y: &Path) -> Result<FlowField, Error> {
        let [field, x, y] = [field, x, y].map(Path::to_path_buf);
        let paths = FlowPaths { field, x, y };
        let mut read = paths.read(&mut self.inputs)?;
        read.check(paths.names(), self.boundary)?;
        read.turn(self.y_axis);
        Ok(read)
    }
}

/// The files of a flow field.
struct FlowPaths {
    field: PathBuf,
    x: PathBuf,
    y: PathBuf,
}

impl FlowPaths {
    fn names(&self) -> FlowNames<'_> {
        FlowNames { field: &self.field, x: &self.x, y: &self.y }
    }

    /// Reads the files as they are: not yet checked, y in the direction of the file.
    fn read(&self, inputs: &mut Vec<InputFile>) -> Result<FlowField, Error> {
        let mut read = |path| {
            let (bytes, record) = read_input(path)?;
            inputs.push(record);
            Ok::<_, Error>(bytes)
        };
        Ok(FlowField {
            velocities: parse_field(&self.field, &read(&self.field)?)?,
            x: parse_row(&self.x, &read(&self.x)?, "(nx,)")?,
            y: parse_row(&self.y, &read(&self.y)?, "(ny,)")?,
        })
    }
}

/// Whether anything has this name; a dangling link counts, so that it is not silently ignored.
fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

fn first_text(given: &Option<String>, stored: Option<String>, default: &str) -> String {
    let given = given.clone().or(stored);
    given.unwrap_or_else(|| default.to_owned())
}

/// Reads and records positions or velocities.
pub(crate) fn read_vectors(path: &Path, inputs: &mut Vec<InputFile>) -> Result<ndarray::Array3<f64>, Error> {
    let (bytes, record) = read_input(path)?;
    inputs.push(record);
    parse_vectors(path, &bytes)
}

/// A number for each cell; one row of shape (cells,) holds in every frame.
fn read_of_cells<T: Clone>(
    path: &Path,
    data: &mut DataSet,
    parse: impl Fn(&Path, &[u8]) -> Result<ArrayD<T>, Error>,
) -> Result<Array2<T>, Error> {
    let (bytes, record) = read_input(path)?;
    data.inputs.push(record);
    let numbers = parse(path, &bytes)?;
    let found = numbers.shape().to_vec();
    let failure = |fault| Error::Shape { path: path.to_path_buf(), fault };
    let (frames, cells) = (data.frames(), data.cells());
    match found.as_slice() {
        [count] if *count == cells => {
            let one_row = numbers.insert_axis(Axis(0));
            let repeated = one_row.broadcast((frames, cells));
            repeated.map(|view| view.to_owned())
        }
        [_, _] => numbers.into_dimensionality::<Ix2>().ok(),
        [_] => {
            return Err(failure(ShapeFault::Mismatch { found, positions: data.positions.shape().to_vec() }));
        }
        _ => None,
    }
    .ok_or_else(|| failure(ShapeFault::Dimensions { found, expected: "(cells,) or (frames, cells)" }))
}
