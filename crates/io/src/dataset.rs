//! The data set in memory.

use ndarray::{Array2, Array3};

use crate::boundary::Boundary;
use crate::field_of_view::SeenArea;
use crate::flow::FlowField;
use crate::input::InputFile;
use crate::measurement::{DeclaredWindow, PositionsAre};
use crate::noise::Noise;
use crate::walled_sides::WalledSides;
use crate::y_axis::YAxis;

/// Tracked cells: positions, perhaps velocities, a flow field and labels, and what their numbers mean.
///
/// Made by [`Source::load`](crate::Source::load), by an import, or field by field from a
/// simulation; [`DataSet::check`] holds a hand-made one to the same rules.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// (frames, cells, 2) in `length_unit`, y up, NaN in both coordinates where a cell is absent.
    pub positions: Array3<f64>,
    /// Same shape, `length_unit` per `time_unit`, y up, NaN where not measured.
    pub velocities: Option<Array3<f64>>,
    /// Velocities on a grid, for as many frames, instead of those of cells or besides them.
    pub flow: Option<FlowField>,
    /// (frames, cells): a measured label of each cell.
    pub labels: Option<Array2<i64>>,
    /// (frames, cells): standard deviation of each coordinate of a cell, in `length_unit`.
    pub position_errors: Option<Array2<f64>>,
    /// What of a cell a position is, where known.
    pub positions_are: Option<PositionsAre>,
    /// What a grid point of the flow field stands for, as far as known.
    pub window: DeclaredWindow,
    /// What is around the cells.
    pub boundary: Boundary,
    /// Under simple shear of a periodic box, displacement along x of the image one box above, y up, in each frame.
    pub box_offset: Option<Vec<f64>>,
    /// Walls at sides of the box, where it does not repeat.
    pub walls: Option<WalledSides>,
    /// Time between frames in `time_unit`.
    pub frame_interval: f64,
    /// Name of the unit of length.
    pub length_unit: String,
    /// Name of the unit of time.
    pub time_unit: String,
    /// The y direction in the files. In memory y is up in either case.
    pub y_axis: YAxis,
    /// Whether positions run on across the periodic boundary instead of re-entering the box.
    pub unwrapped: bool,
    /// Standard deviation of a position coordinate, where known.
    pub position_noise: Option<Noise>,
    /// Standard deviation of a velocity component, where known.
    pub velocity_noise: Option<Noise>,
    /// Where every cell would have been seen, in an open field, where known; y up.
    pub field_of_view: Option<SeenArea>,
    /// The files that were read, in reading order.
    pub inputs: Vec<InputFile>,
}

impl DataSet {
    /// Positions (frames, cells, 2), y up, and nothing else: one time unit between frames, lengths and times without units.
    #[must_use]
    pub fn new(positions: Array3<f64>, boundary: Boundary) -> Self {
        Self {
            positions,
            velocities: None,
            flow: None,
            labels: None,
            position_errors: None,
            positions_are: None,
            window: DeclaredWindow::default(),
            boundary,
            box_offset: None,
            walls: None,
            frame_interval: 1.0,
            length_unit: "length".to_owned(),
            time_unit: "time".to_owned(),
            y_axis: YAxis::Up,
            unwrapped: false,
            position_noise: None,
            velocity_noise: None,
            field_of_view: None,
            inputs: Vec::new(),
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.positions.dim().0
    }

    /// Length of the cell axis, whether or not a cell is present in every frame.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.positions.dim().1
    }

    /// Takes an image, its size in units of length, for the field of view if that holds all cells. Positions are turned
    /// already.
    pub(crate) fn see_within_image(&mut self, size: [f64; 2]) {
        let area = SeenArea::image(size, self.y_axis);
        let fits = self.boundary == Boundary::Open && area.first_outside(&self.positions).is_none();
        self.field_of_view = fits.then_some(area);
    }
}
