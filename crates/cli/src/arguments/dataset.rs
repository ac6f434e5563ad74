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
    /// Folder with positions.npy, dataset.toml and, where there are any, velocities.npy or flow.npy.
    #[arg(value_name = "DATASET")]
    pub dataset: Option<PathBuf>,
    /// Positions (N, 2) or (frames, N, 2), .npy, instead of the folder's.
    #[arg(long, value_name = "FILE")]
    pub positions: Option<PathBuf>,
    /// Velocities of the same shape.
    #[arg(long, value_name = "FILE")]
    pub velocities: Option<PathBuf>,
    /// Labels of the cells (N,) or (frames, N), integers, .npy; -1 for none.
    #[arg(long, value_name = "FILE")]
    pub labels: Option<PathBuf>,
    /// Standard deviation of each coordinate of a cell (N,) or (frames, N), .npy.
    #[arg(long, value_name = "FILE")]
    pub position_errors: Option<PathBuf>,
    /// Flow field on a grid (ny, nx, 2) or (frames, ny, nx, 2), .npy.
    #[arg(long, value_name = "FILE")]
    pub flow: Option<PathBuf>,
    /// x of the columns of the flow field, .npy.
    #[arg(long, value_name = "FILE")]
    pub flow_x: Option<PathBuf>,
    /// y of the rows of the flow field, .npy.
    #[arg(long, value_name = "FILE")]
    pub flow_y: Option<PathBuf>,
    /// Periodic box.
    #[arg(long = "box", num_args = 2, value_names = ["LX", "LY"], conflicts_with = "open", allow_negative_numbers = true)]
    pub box_lengths: Option<Vec<f64>>,
    /// Open field of view.
    #[arg(long)]
    pub open: bool,
    /// Rectangle in which every cell would have been seen, in an open field [default: that of the data set, or the hull of the
    /// cells of each frame].
    #[arg(long, num_args = 4, value_names = ["X0", "Y0", "X1", "Y1"], allow_negative_numbers = true)]
    pub field_of_view: Option<Vec<f64>>,
    /// Time between frames.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub frame_interval: Option<f64>,
    /// Unit of length, for display.
    #[arg(long, value_name = "UNIT")]
    pub length_unit: Option<String>,
    /// Unit of time, for display.
    #[arg(long, value_name = "UNIT")]
    pub time_unit: Option<String>,
    /// Direction of y in the files: `up`, or `down` as in images.
    #[arg(long, value_name = "up|down")]
    pub y_axis: Option<YAxis>,
    /// Periodic trajectories that leave the box are meant to.
    #[arg(long)]
    pub unwrapped: bool,
    /// Standard deviation of a coordinate, in data units or as a percentage of the cell size: `0.4`, `2%`.
    #[arg(long, value_name = "NOISE", allow_hyphen_values = true)]
    pub position_noise: Option<Noise>,
    /// Standard deviation of a velocity component, in data units or as a percentage of the rms velocity.
    #[arg(long, value_name = "NOISE", allow_hyphen_values = true)]
    pub velocity_noise: Option<Noise>,
    /// What of a cell a position is: `sites`, `centroids`, or the share of the way from one to the other.
    #[arg(long, value_name = "sites|centroids|SHARE", allow_negative_numbers = true)]
    pub positions_are: Option<PositionsAre>,
    /// What a grid point of the flow field stands for: the average over a `square` in which every point moves with its cell, over
    /// the centres of cells with `gaussian` weights, or over the plane with such weights, `gaussian-area`.
    #[arg(long, value_name = "KIND")]
    pub window: Option<WindowKind>,
    /// Side of a square window or standard deviation of a Gaussian one, a length.
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
