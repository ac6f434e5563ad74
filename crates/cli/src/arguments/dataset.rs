//! Which data: a folder, single files, or both.

use crate::failure::Failure;
use clap::Args;
use std::path::{Path, PathBuf};
use voronudge_io::{
    Boundary, DataSet, DeclaredWindow, Noise, PositionsAre, SeenArea, Source, WindowKind, YAxis,
};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Data")]
pub(crate) struct DataSetArguments {
    /// Folder with positions.npy, dataset.toml and, optionally, velocities.npy or flow.npy.
    #[arg(value_name = "DATASET")]
    pub dataset: Option<PathBuf>,
    /// Positions: .npy file of shape (N, 2) or (frames, N, 2) [default: positions.npy of the folder].
    #[arg(long, value_name = "FILE")]
    pub positions: Option<PathBuf>,
    /// Velocities: .npy file of the same shape as the positions [default: velocities.npy of the folder].
    #[arg(long, value_name = "FILE")]
    pub velocities: Option<PathBuf>,
    /// Labels of the cells: .npy file of integers of shape (N,) or (frames, N), -1 for a cell without a label
    /// [default: labels.npy of the folder].
    #[arg(long, value_name = "FILE")]
    pub labels: Option<PathBuf>,
    /// Position errors: .npy file of shape (N,) or (frames, N) with the standard deviation of each coordinate of a
    /// cell [default: position_errors.npy of the folder].
    #[arg(long, value_name = "FILE")]
    pub position_errors: Option<PathBuf>,
    /// Flow field, velocities on a grid: .npy file of shape (ny, nx, 2) or (frames, ny, nx, 2) [default: flow.npy of
    /// the folder].
    #[arg(long, value_name = "FILE")]
    pub flow: Option<PathBuf>,
    /// x of the columns of the flow field: .npy file of shape (nx,) [default: flow_x.npy of the folder].
    #[arg(long, value_name = "FILE")]
    pub flow_x: Option<PathBuf>,
    /// y of the rows of the flow field: .npy file of shape (ny,) [default: flow_y.npy of the folder].
    #[arg(long, value_name = "FILE")]
    pub flow_y: Option<PathBuf>,
    /// Sides of the periodic box, in the unit of length; not with --open [default: as stated in dataset.toml].
    #[arg(long = "box", num_args = 2, value_names = ["LX", "LY"], conflicts_with = "open", allow_negative_numbers = true)]
    pub box_lengths: Option<Vec<f64>>,
    /// The cells are in an open field of view, not in a periodic box [default: as stated in dataset.toml].
    #[arg(long)]
    pub open: bool,
    /// Two opposite corners of the rectangle in which every cell would have been seen, for an open field of view
    /// [default: that of the data set, or the hull of the cells of each frame].
    #[arg(long, num_args = 4, value_names = ["X0", "Y0", "X1", "Y1"], allow_negative_numbers = true)]
    pub field_of_view: Option<Vec<f64>>,
    /// Time between frames [default: that of the data set, or 1].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub frame_interval: Option<f64>,
    /// Name of the unit of length, for display [default: that of the data set, or `length`].
    #[arg(long, value_name = "UNIT")]
    pub length_unit: Option<String>,
    /// Name of the unit of time, for display [default: that of the data set, or `time`].
    #[arg(long, value_name = "UNIT")]
    pub time_unit: Option<String>,
    /// Direction of the y axis in the files: `up`, or `down` as in images [default: that of the data set, or `up`].
    #[arg(long, value_name = "up|down")]
    pub y_axis: Option<YAxis>,
    /// Positions are unwrapped: trajectories continue across the boundary of the periodic box.
    #[arg(long)]
    pub unwrapped: bool,
    /// Measurement error of the positions: the standard deviation of a coordinate, in data units or as a percentage
    /// of the cell size, such as `0.4` or `2%` [default: that of the data set; if it has none, fits estimate it].
    #[arg(long, value_name = "NOISE", allow_hyphen_values = true)]
    pub position_noise: Option<Noise>,
    /// Measurement error of the velocities: the standard deviation of a component, in data units or as a percentage
    /// of the rms velocity [default: that of the data set; if it has none, fits estimate it].
    #[arg(long, value_name = "NOISE", allow_hyphen_values = true)]
    pub velocity_noise: Option<Noise>,
    /// Which point of a cell its position is: the Voronoi site (`sites`), the centroid (`centroids`), or a point
    /// between them, given as the share of the way from site to centroid, 0 to 1 [default: that of the data set; if
    /// it has none, fits estimate it and other commands assume sites].
    #[arg(long, value_name = "sites|centroids|SHARE", allow_negative_numbers = true)]
    pub positions_are: Option<PositionsAre>,
    /// What a grid point of the flow field represents: the average over a `square` in which every point moves with
    /// its cell, over the centres of cells with `gaussian` weights, or over the plane with such weights
    /// (`gaussian-area`) [default: that of the data set; if it has none, fits estimate it and other commands assume
    /// squares].
    #[arg(long, value_name = "KIND")]
    pub window: Option<WindowKind>,
    /// Width of the window, a length: the side of a square, or the standard deviation of a Gaussian; with --window
    /// [default: that of the data set; if it has none, fits estimate it and other commands assume the grid spacing
    /// for a square and half of it for a Gaussian].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub window_width: Option<f64>,
}

impl DataSetArguments {
    /// The field of view given, y as in the files.
    fn field_of_view(&self) -> Option<SeenArea> {
        let ends = self.field_of_view.as_deref()?;
        <[f64; 4]>::try_from(ends).ok().map(SeenArea::Rectangle)
    }

    /// The same of the folder of another data set, with its own files.
    pub fn of_folder(&self, folder: &Path) -> Self {
        Self {
            dataset: Some(folder.to_owned()),
            positions: None,
            velocities: None,
            labels: None,
            position_errors: None,
            flow: None,
            flow_x: None,
            flow_y: None,
            ..self.clone()
        }
    }

    /// Reads and checks the data.
    pub fn load(&self) -> Result<DataSet, Failure> {
        if self.dataset.is_none() && self.positions.is_none() {
            return Err(Failure::new("no data are given")
                .with_hint("name a data set folder, or give --positions FILE with --box LX LY or --open"));
        }
        let boundary = match (&self.box_lengths, self.open) {
            (Some(lengths), _) => Some(Boundary::Periodic { lengths: [lengths[0], lengths[1]] }),
            (None, true) => Some(Boundary::Open),
            (None, false) => None,
        };
        let source = Source {
            folder: self.dataset.clone(),
            positions: self.positions.clone(),
            velocities: self.velocities.clone(),
            labels: self.labels.clone(),
            position_errors: self.position_errors.clone(),
            flow: self.flow.clone(),
            flow_x: self.flow_x.clone(),
            flow_y: self.flow_y.clone(),
            boundary,
            frame_interval: self.frame_interval,
            length_unit: self.length_unit.clone(),
            time_unit: self.time_unit.clone(),
            y_axis: self.y_axis,
            unwrapped: self.unwrapped.then_some(true),
            position_noise: self.position_noise,
            velocity_noise: self.velocity_noise,
            field_of_view: self.field_of_view(),
            positions_are: self.positions_are,
            window: DeclaredWindow { kind: self.window, width: self.window_width },
        };
        Ok(source.load()?)
    }

    /// The file that holds the positions, for messages.
    pub fn positions_file(&self) -> PathBuf {
        self.file(self.positions.as_ref(), "positions.npy")
    }

    /// The file that holds the velocities, for messages.
    pub fn velocities_file(&self) -> PathBuf {
        self.file(self.velocities.as_ref(), "velocities.npy")
    }

    /// The file that holds the flow field, for messages.
    pub fn flow_file(&self) -> PathBuf {
        self.file(self.flow.as_ref(), "flow.npy")
    }

    fn file(&self, given: Option<&PathBuf>, name: &str) -> PathBuf {
        match (given, &self.dataset) {
            (Some(file), _) => file.clone(),
            (None, Some(folder)) => folder.join(name),
            (None, None) => PathBuf::from(name),
        }
    }
}
