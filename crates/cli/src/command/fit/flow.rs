//! Velocities on a grid: which, averaged how, and in which order rows and columns are.

use crate::arguments::DataSetArguments;
use crate::failure::Failure;
use crate::snapshot::{as_given, y_sign};
use clap::{Args, ValueEnum};
use ndarray::{Array4, ArrayD, Axis};
use voronudge_geometry::{Grid, Vector};
use voronudge_infer::{Flow, Scale, Window};
use voronudge_io::{DataSet, FlowField};
use voronudge_report::infer_report::{FlowGrid, FlowWindow};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Velocities")]
pub(crate) struct FlowArguments {
    /// Velocities to explain: those of cells, or a flow field on a grid [default: flow if there is a flow field and no
    /// velocities of cells].
    #[arg(long, value_enum)]
    data: Option<Kind>,
    /// What a grid point of the flow field stands for [default: square].
    #[arg(long, value_enum)]
    window: Option<WindowShape>,
    /// Standard deviation of a Gaussian window, a length [default: half the grid spacing].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    window_width: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Given velocities of cells, or those derived from tracks.
    Cells,
    /// A flow field.
    Flow,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum WindowShape {
    /// The average over the square around it, in which every point moves with its cell.
    Square,
    /// The average over the centres of cells with Gaussian weights.
    Gaussian,
}

impl FlowArguments {
    /// The flow field to explain, if it is one.
    pub fn field(&self, files: &DataSetArguments, data: &DataSet) -> Result<Option<OrderedField>, Failure> {
        let wanted = match self.data {
            Some(kind) => kind == Kind::Flow,
            None => data.flow.is_some() && data.velocities.is_none(),
        };
        match (&data.flow, wanted) {
            (Some(field), true) => Ok(Some(OrderedField::new(field, self.window(field)?)?)),
            (None, true) => Err(Failure::new("there is no flow field")
                .with_hint("give --flow with --flow-x and --flow-y, or --data cells")
                .at(files.flow_file().display())),
            (_, false) => {
                let unused =
                    [("--window", self.window.is_some()), ("--window-width", self.window_width.is_some())];
                match unused.into_iter().find(|(_, given)| *given) {
                    Some((option, _)) => {
                        Err(Failure::new(format!("{option} is for flow fields, but velocities are of cells"))
                            .with_hint(format!("leave out {option}, or give --data flow")))
                    }
                    None => Ok(None),
                }
            }
        }
    }

    fn window(&self, field: &FlowField) -> Result<Window, Failure> {
        match (self.window, self.window_width) {
            (None | Some(WindowShape::Square), None) => Ok(Window::Square),
            (None | Some(WindowShape::Square), Some(_)) => Err(Failure::new(
                "--window-width is for --window gaussian, but the window is a square",
            )
            .with_hint(
                "a square is as wide as the grid spacing; give --window gaussian or leave the width out",
            )),
            (Some(WindowShape::Gaussian), None) => {
                let [dx, dy] = field.spacing();
                Ok(Window::Gaussian { width: 0.5 * (dx * dy).sqrt() })
            }
            (Some(WindowShape::Gaussian), Some(width)) if width.is_finite() && width > 0.0 => {
                Ok(Window::Gaussian { width })
            }
            (Some(WindowShape::Gaussian), Some(width)) => {
                Err(Failure::new(format!("--window-width is {width}, but it must be finite and above zero"))
                    .with_hint("leave it out for half the grid spacing"))
            }
        }
    }
}

/// A flow field with rows and columns in the order of ascending coordinates, as the geometry has them.
pub(crate) struct OrderedField {
    /// (frames, ny, nx, 2)
    velocities: Array4<f64>,
    /// Whether x and y descend in the file.
    descends: [bool; 2],
    grid: Grid,
    window: Window,
}

impl OrderedField {
    /// The field with what each of its points stands for.
    pub fn new(field: &FlowField, window: Window) -> Result<Self, Failure> {
        let mut velocities = field.velocities.clone();
        let axes = [&field.x, &field.y];
        let descends = axes.map(|coordinates| coordinates.first() > coordinates.last());
        for (axis, _) in [Axis(2), Axis(1)].into_iter().zip(descends).filter(|(_, descends)| *descends) {
            velocities.invert_axis(axis);
        }
        let origin = axes.map(|coordinates| coordinates.iter().copied().fold(f64::INFINITY, f64::min));
        let grid = Grid::new(origin, field.spacing(), axes.map(Vec::len))?;
        Ok(Self { velocities, descends, grid, window })
    }

    /// What the model is to explain in one frame.
    pub fn frame(&self, frame: usize) -> Flow {
        let velocities = self
            .velocities
            .index_axis(Axis(0), frame)
            .lanes(Axis(2))
            .into_iter()
            .map(|v| Some(Vector::new(v[0], v[1])).filter(|v| v.x.is_finite() && v.y.is_finite()))
            .collect();
        Flow { grid: self.grid, velocities, window: self.window }
    }

    /// Whether a frame has a velocity anywhere.
    pub fn has_velocity(&self, frame: usize) -> bool {
        self.velocities.index_axis(Axis(0), frame).iter().any(|v| v.is_finite())
    }

    /// x of the columns and y of the rows, ascending.
    pub fn coordinates(&self) -> [Vec<f64>; 2] {
        let [columns, rows] = self.grid.size();
        [
            (0..columns).map(|column| self.grid.centre(column).x).collect(),
            (0..rows).map(|row| self.grid.centre(row * columns).y).collect(),
        ]
    }

    /// Vectors at the grid points of several frames, as an array (frames, ny, nx, 2) in the order of the file and with
    /// y as there; (ny, nx, 2) if the data set has a single frame.
    pub fn to_array(&self, data: &DataSet, frames: &[Vec<Vector<f64>>]) -> ArrayD<f64> {
        let [columns, rows] = self.grid.size();
        let flip = y_sign(data);
        let mut array =
            Array4::from_shape_fn((frames.len(), rows, columns, 2), |(frame, row, column, axis)| {
                let v = frames[frame][row * columns + column];
                if axis == 0 { v.x } else { flip * v.y }
            });
        for (axis, _) in [Axis(2), Axis(1)].into_iter().zip(self.descends).filter(|(_, descends)| *descends) {
            array.invert_axis(axis);
        }
        as_given(data, array.as_standard_layout().into_owned())
    }

    /// The grid for the report.
    pub fn described(&self) -> FlowGrid {
        let (window, width) = match self.window {
            Window::Square => (FlowWindow::Square, None),
            Window::Gaussian { width } => (FlowWindow::Gaussian, Some(width)),
        };
        FlowGrid { grid_points: self.grid.size(), spacing: self.grid.spacing(), window, width }
    }
}

/// A flow field in the units of a fit.
pub(crate) fn scaled(flow: &Flow, scale: &Scale) -> Result<Flow, Failure> {
    let lengths = |lengths: [f64; 2]| lengths.map(|length| length / scale.length);
    let origin = flow.grid.centre(0);
    Ok(Flow {
        grid: Grid::new(lengths([origin.x, origin.y]), lengths(flow.grid.spacing()), flow.grid.size())?,
        velocities: flow.velocities.iter().map(|v| v.map(|v| v / scale.velocity())).collect(),
        window: match flow.window {
            Window::Square => Window::Square,
            Window::Gaussian { width } => Window::Gaussian { width: width / scale.length },
        },
    })
}
