//! Velocities on a grid, with rows and columns in the order of the geometry.

use ndarray::{Array4, ArrayD, Axis};
use voronudge_geometry::{Grid, Vector};
use voronudge_infer::{Flow, Window, WindowKind};
use voronudge_io::{DataSet, DeclaredWindow, FlowField};

/// The kind of window as the fit knows it.
pub(super) fn kind(declared: voronudge_io::WindowKind) -> WindowKind {
    match declared {
        voronudge_io::WindowKind::Square => WindowKind::Square,
        voronudge_io::WindowKind::Gaussian => WindowKind::Gaussian,
        voronudge_io::WindowKind::GaussianArea => WindowKind::GaussianArea,
    }
}

/// A flow field with rows and columns in the order of ascending coordinates, as the geometry has them.
#[derive(Debug, Clone)]
pub struct OrderedField {
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
    ///
    /// # Errors
    /// Those of [`Grid::new`].
    pub fn new(field: &FlowField, declared: DeclaredWindow) -> Result<Self, voronudge_geometry::Error> {
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

    /// What its points are taken to stand for.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Takes another window for what its points stand for.
    pub(super) fn take(&mut self, window: Window) {
        self.window = window;
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.velocities.dim().0
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

    /// x of the columns (nx) and y of the rows (ny), ascending.
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
        let flip = data.y_sign();
        let mut array =
            Array4::from_shape_fn((frames.len(), rows, columns, 2), |(frame, row, column, axis)| {
                let v = frames[frame][row * columns + column];
                if axis == 0 { v.x } else { flip * v.y }
            });
        for (axis, _) in [Axis(2), Axis(1)].into_iter().zip(self.descends).filter(|(_, descends)| *descends) {
            array.invert_axis(axis);
        }
        data.as_given(array.as_standard_layout().into_owned())
    }
}
