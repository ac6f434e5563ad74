//! Velocities on a grid: which, averaged how, and in which order rows and columns are.

use crate::arguments::DataSetArguments;
use crate::failure::Failure;
use crate::snapshot::{as_given, y_sign};
use clap::{Args, ValueEnum};
use ndarray::{Array4, ArrayD, Axis};
use voronudge_geometry::{Grid, Vector};
use voronudge_infer::{Flow, Scale, Window, WindowKind};
use voronudge_io::{DataSet, DeclaredWindow, FlowField};
use voronudge_report::infer_report::{FlowGrid, FlowWindow};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Velocities")]
pub(crate) struct FlowArguments {
    /// Velocities to explain: those of cells, or a flow field on a grid [default: flow if there is a flow field and no
    /// velocities of cells].
    #[arg(long, value_enum)]
    data: Option<Kind>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Given velocities of cells, or those derived from tracks.
    Cells,
    /// A flow field.
    Flow,
}

impl FlowArguments {
    /// The flow field to explain, if it is one.
    pub fn field(&self, files: &DataSetArguments, data: &DataSet) -> Result<Option<OrderedField>, Failure> {
        let wanted = match self.data {
            Some(kind) => kind == Kind::Flow,
            None => data.flow.is_some() && data.velocities.is_none(),
        };
        match (&data.flow, wanted) {
            (Some(field), true) => Ok(Some(OrderedField::new(field, data.window)?)),
            (None, true) => Err(Failure::new("there is no flow field")
                .with_hint("give --flow with --flow-x and --flow-y, or --data cells")
                .at(files.flow_file().display())),
            (_, false) => {
                let unused =
                    [("--window", files.window.is_some()), ("--window-width", files.window_width.is_some())];
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
}

/// The kind of window as the fit knows it.
pub(super) fn kind(declared: voronudge_io::WindowKind) -> WindowKind {
    match declared {
        voronudge_io::WindowKind::Square => WindowKind::Square,
        voronudge_io::WindowKind::Gaussian => WindowKind::Gaussian,
        voronudge_io::WindowKind::GaussianArea => WindowKind::GaussianArea,
    }
}

/// The kind of window as reports name it.
pub(super) fn told(kind: WindowKind) -> FlowWindow {
    match kind {
        WindowKind::Square => FlowWindow::Square,
        WindowKind::Gaussian => FlowWindow::Gaussian,
        WindowKind::GaussianArea => FlowWindow::GaussianArea,
    }
}

/// The kind of window in words.
pub(super) fn name(kind: WindowKind) -> &'static str {
    match kind {
        WindowKind::Square => "squares",
        WindowKind::Gaussian => "Gaussians over the centres of cells",
        WindowKind::GaussianArea => "Gaussians over the plane",
    }
}

/// A flow field with rows and columns in the order of ascending coordinates, as the geometry has them.
#[derive(Clone)]
pub(crate) struct OrderedField {
    /// (frames, ny, nx, 2)
    velocities: Array4<f64>,
    /// Whether x and y descend in the file.
    descends: [bool; 2],
    grid: Grid,
    declared: DeclaredWindow,
    window: Window,
}

impl OrderedField {
    /// The field with what is declared of the windows of its points; what is not is as usual.
    pub fn new(field: &FlowField, declared: DeclaredWindow) -> Result<Self, Failure> {
        let mut velocities = field.velocities.clone();
        let axes = [&field.x, &field.y];
        let descends = axes.map(|coordinates| coordinates.first() > coordinates.last());
        for (axis, _) in [Axis(2), Axis(1)].into_iter().zip(descends).filter(|(_, descends)| *descends) {
            velocities.invert_axis(axis);
        }
        let origin = axes.map(|coordinates| coordinates.iter().copied().fold(f64::INFINITY, f64::min));
        let grid = Grid::new(origin, field.spacing(), axes.map(Vec::len))?;
        let kind = declared.kind.map_or(WindowKind::Square, kind);
        let window = Window { kind, width: declared.width.unwrap_or_else(|| kind.usual_width(&grid)) };
        Ok(Self { velocities, descends, grid, declared, window })
    }

    /// What is declared of the windows.
    pub fn declared(&self) -> DeclaredWindow {
        self.declared
    }

    /// Takes another window for what its points stand for.
    pub fn take(&mut self, window: Window) {
        self.window = window;
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
        let Window { kind, width } = self.window;
        FlowGrid { grid_points: self.grid.size(), spacing: self.grid.spacing(), window: told(kind), width }
    }
}

/// A flow field in the units of a fit.
pub(crate) fn scaled(flow: &Flow, scale: &Scale) -> Result<Flow, Failure> {
    let lengths = |lengths: [f64; 2]| lengths.map(|length| length / scale.length);
    let origin = flow.grid.centre(0);
    Ok(Flow {
        grid: Grid::new(lengths([origin.x, origin.y]), lengths(flow.grid.spacing()), flow.grid.size())?,
        velocities: flow.velocities.iter().map(|v| v.map(|v| v / scale.velocity())).collect(),
        window: Window { width: flow.window.width / scale.length, ..flow.window },
    })
}
