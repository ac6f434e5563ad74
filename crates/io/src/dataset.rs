//! The data set in memory.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use ndarray::{Array, Array2, Array3, Axis, RemoveAxis};

use crate::error::{Error, SettingFault};
use crate::field_of_view::SeenArea;
use crate::flow::{FlowField, FlowNames};
use crate::input::InputFile;
use crate::measurement::{DeclaredWindow, PositionsAre};
use crate::noise::Noise;
use crate::validate;

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

/// What is around the cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// A rectangular box that repeats.
    Periodic {
        /// Box lengths along x and y in the unit of length.
        lengths: [f64; 2],
    },
    /// A field of view whose surroundings are not seen.
    Open,
}

/// Sides of a periodic box that are walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalledSides {
    /// The left and the right one: a channel.
    X,
    /// All four.
    Both,
}

/// The direction of the stored y coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum YAxis {
    /// Larger y is further up, as in mathematics.
    #[default]
    Up,
    /// Larger y is further down, as in images.
    Down,
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

    /// Checks every rule that a loaded data set obeys.
    ///
    /// # Errors
    /// [`Error::Shape`] for no frames, no cells or arrays that disagree; [`Error::Value`] for
    /// infinities, half-absent cells, two cells in one place, a box that cannot be right;
    /// [`Error::Grid`] for a flow field or a grid that cannot be used; [`Error::Setting`] for
    /// lengths, intervals and noise out of range. Arrays are named as in a folder:
    /// `positions.npy`, `velocities.npy`, `labels.npy`, `position_errors.npy`, `flow.npy`, `flow_x.npy`, `flow_y.npy`.
    pub fn check(&self) -> Result<(), Error> {
        self.check_settings().map_err(Error::Setting)?;
        self.check_arrays(&validate::ArrayNames {
            positions: Path::new("positions.npy"),
            velocities: Path::new("velocities.npy"),
            labels: Path::new("labels.npy"),
            position_errors: Path::new("position_errors.npy"),
            flow: FlowNames::in_folder(),
        })
    }

    pub(crate) fn check_settings(&self) -> Result<(), SettingFault> {
        self.boundary.check()?;
        validate::positive("frame_interval", self.frame_interval)?;
        self.window.check(self.boundary)?;
        let name = if self.walls.is_some() { "walls" } else { "box_offset" };
        if self.boundary == Boundary::Open && (self.box_offset.is_some() || self.walls.is_some()) {
            return Err(SettingFault::NeedsBox { key: name });
        }
        if let Some(area) = &self.field_of_view {
            area.check(self.boundary)?;
        }
        if let Some(&value) = self.box_offset.iter().flatten().find(|offset| !offset.is_finite()) {
            return Err(SettingFault::NotFinite { key: "box_offset", value });
        }
        for (key, noise) in [("position_noise", self.position_noise), ("velocity_noise", self.velocity_noise)]
        {
            if let Some(noise) = noise {
                noise.check(key)?;
            }
        }
        Ok(())
    }
}

impl Boundary {
    pub(crate) fn check(&self) -> Result<(), SettingFault> {
        match self {
            Self::Open => Ok(()),
            Self::Periodic { lengths } => {
                lengths.iter().try_for_each(|&length| validate::positive("box length", length))
            }
        }
    }
}

impl WalledSides {
    pub(crate) fn parse(text: &str) -> Result<Self, SettingFault> {
        match text {
            "x" => Ok(Self::X),
            "both" => Ok(Self::Both),
            _ => Err(SettingFault::Unknown {
                key: "walls",
                found: text.to_owned(),
                expected: "\"x\" or \"both\"",
            }),
        }
    }
}

impl fmt::Display for WalledSides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Both => "both",
        })
    }
}

impl YAxis {
    /// Turns offsets of the box of a file into those of y up or back: a mirror reverses the shear.
    pub(crate) fn turn_offsets(self, offsets: &mut [f64]) {
        if self == Self::Down {
            offsets.iter_mut().for_each(|offset| *offset = 0.0 - *offset);
        }
    }

    /// Turns stored vectors into y-up vectors or back; the two directions are the same.
    ///
    /// The last axis holds x, y.
    pub(crate) fn turn<D: RemoveAxis>(self, vectors: &mut Array<f64, D>) {
        if self == Self::Down {
            let last = Axis(vectors.ndim() - 1);
            // 0 − y rather than −y, so that no negative zero appears.
            let mut y = vectors.index_axis_mut(last, 1);
            y.mapv_inplace(|value| 0.0 - value);
        }
    }

    pub(crate) fn parse(text: &str) -> Result<Self, SettingFault> {
        match text {
            "up" => Ok(Self::Up),
            "down" => Ok(Self::Down),
            _ => Err(SettingFault::Unknown {
                key: "y_axis",
                found: text.to_owned(),
                expected: "\"up\" or \"down\"",
            }),
        }
    }
}

impl FromStr for YAxis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text).map_err(Error::Setting)
    }
}

impl fmt::Display for YAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Up => "up",
            Self::Down => "down",
        })
    }
}
