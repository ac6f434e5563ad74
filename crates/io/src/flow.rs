//! Velocities on a grid, as optical flow or particle image velocimetry measure them.

use std::path::Path;

use ndarray::{Array4, Axis};

use crate::boundary::Boundary;
use crate::error::{Error, GridFault, ShapeFault};
use crate::y_axis::YAxis;

/// How far a coordinate may be from an even grid, in spacings.
const UNEVENNESS: f64 = 1e-4;

/// A field of velocities on a rectangular grid.
///
/// Point (row, column) is at (`x[column]`, `y[row]`). Each axis has at least two points, evenly
/// spaced, ascending or descending: as in the files, except that a file with y down has the sign
/// of its y turned. So y usually descends where it was read from image rows.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowField {
    /// (frames, ny, nx, 2) in `length_unit` per `time_unit`, y up, NaN in both components where
    /// the point is missing.
    pub velocities: Array4<f64>,
    /// x of the columns, (nx), in `length_unit`.
    pub x: Vec<f64>,
    /// y of the rows, (ny), in `length_unit`, y up.
    pub y: Vec<f64>,
}

/// The files a flow field came from, for messages.
#[derive(Clone, Copy)]
pub(crate) struct FlowNames<'a> {
    pub(crate) field: &'a Path,
    pub(crate) x: &'a Path,
    pub(crate) y: &'a Path,
}

impl FlowNames<'_> {
    /// The names in a data set folder.
    pub(crate) fn in_folder() -> Self {
        Self { field: Path::new("flow.npy"), x: Path::new("flow_x.npy"), y: Path::new("flow_y.npy") }
    }
}

impl FlowField {
    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.velocities.dim().0
    }

    /// Distance between neighbouring grid points along x and y in `length_unit`, above zero
    /// whether coordinates ascend or descend.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        [&self.x, &self.y].map(|coordinates| step(coordinates).abs())
    }

    /// Number of grid points without a velocity, summed over frames.
    #[must_use]
    pub fn missing(&self) -> usize {
        let points = self.velocities.lanes(Axis(3)).into_iter();
        points.filter(|point| point.iter().any(|component| component.is_nan())).count()
    }

    /// Turns a stored field into a y-up field or back; the two directions are the same.
    pub(crate) fn turn(&mut self, y_axis: YAxis) {
        y_axis.turn(&mut self.velocities);
        if y_axis == YAxis::Down {
            self.y.iter_mut().for_each(|y| *y = 0.0 - *y);
        }
    }

    /// Every rule but the number of frames.
    pub(crate) fn check(&self, names: FlowNames<'_>, boundary: Boundary) -> Result<(), Error> {
        let (frames, rows, columns, components) = self.velocities.dim();
        let shape = |fault| Error::Shape { path: names.field.to_path_buf(), fault };
        let found = || self.velocities.shape().to_vec();
        if components != 2 {
            return Err(shape(ShapeFault::NotPairs { found: found(), expected: "(frames, ny, nx, 2)" }));
        }
        if frames == 0 {
            return Err(shape(ShapeFault::Nothing { found: found(), axis: "frames" }));
        }
        for (axis, coordinates, path, expected) in
            [('x', &self.x, names.x, columns), ('y', &self.y, names.y, rows)]
        {
            if coordinates.len() != expected {
                let fault = GridFault::CoordinateCount { axis, found: coordinates.len(), expected };
                return Err(grid_error(path, fault));
            }
            check_coordinates(axis, coordinates).map_err(|fault| grid_error(path, fault))?;
        }
        check_values(names.field, &self.velocities)?;
        if let Boundary::Periodic { lengths } = boundary {
            self.check_extent(names, lengths)?;
        }
        Ok(())
    }

    /// The grid does not meet its own image.
    fn check_extent(&self, names: FlowNames<'_>, lengths: [f64; 2]) -> Result<(), Error> {
        let axes = [('x', &self.x, names.x), ('y', &self.y, names.y)];
        for ((axis, coordinates, path), length) in axes.into_iter().zip(lengths) {
            let spacing = step(coordinates).abs();
            let extent = spacing * (coordinates.len() as f64 - 1.0);
            if extent > length + UNEVENNESS * spacing {
                return Err(grid_error(path, GridFault::BeyondBox { axis, extent, length }));
            }
        }
        Ok(())
    }
}

/// Every velocity is finite or missing as a whole; `path` only names the place.
pub(crate) fn check_values(path: &Path, velocities: &Array4<f64>) -> Result<(), Error> {
    for (frame, rows) in velocities.outer_iter().enumerate() {
        for (row, points) in rows.outer_iter().enumerate() {
            for (column, point) in points.outer_iter().enumerate() {
                let (x, y) = (point[0], point[1]);
                let fault = if x.is_infinite() || y.is_infinite() {
                    GridFault::Infinite { frame, row, column, x, y }
                } else if x.is_nan() != y.is_nan() {
                    GridFault::HalfMissing { frame, row, column, x, y }
                } else {
                    continue;
                };
                return Err(grid_error(path, fault));
            }
        }
    }
    Ok(())
}

pub(crate) fn grid_error(path: &Path, fault: GridFault) -> Error {
    Error::Grid { path: path.to_path_buf(), fault }
}

/// At least two finite numbers that ascend or descend evenly.
fn check_coordinates(axis: char, coordinates: &[f64]) -> Result<(), GridFault> {
    for (index, &value) in coordinates.iter().enumerate() {
        if !value.is_finite() {
            return Err(GridFault::NotFinite { axis, index, value });
        }
    }
    let [first, second, ..] = *coordinates else {
        return Err(GridFault::TooFew { axis, found: coordinates.len() });
    };
    let ascending = second > first;
    for (index, pair) in coordinates.windows(2).enumerate() {
        let goes_on = if ascending { pair[1] > pair[0] } else { pair[1] < pair[0] };
        if !goes_on {
            return Err(GridFault::Turns { axis, index: index + 1, before: pair[0], value: pair[1] });
        }
    }
    let spacing = step(coordinates);
    let largest = coordinates.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    // Coordinates in single precision are off by their rounding, however fine the grid.
    let tolerance = (UNEVENNESS * spacing.abs()).max(f64::from(f32::EPSILON) * largest);
    for (index, &value) in coordinates.iter().enumerate() {
        let expected = first + index as f64 * spacing;
        let even = spacing.is_finite() && (value - expected).abs() <= tolerance;
        if !even {
            return Err(GridFault::Uneven { axis, index, value, expected });
        }
    }
    Ok(())
}

/// Mean step from one coordinate to the next; NaN below two coordinates.
fn step(coordinates: &[f64]) -> f64 {
    match coordinates {
        [first, .., last] => (last - first) / (coordinates.len() as f64 - 1.0),
        _ => f64::NAN,
    }
}
