//! The rules that a data set obeys.

use std::path::Path;

use ndarray::{Array2, Array3, ArrayView2, Axis};

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, GridFault, SettingFault, ShapeFault, ValueFault};
use crate::flow::{FlowNames, grid_error};
use crate::positive::positive;

/// How far positions that were not unwrapped may reach, in box lengths.
///
/// Wrapped positions span less than one length; half a length more allows for cells that have
/// moved on since they were last wrapped.
const EXTENT_LIMIT: f64 = 1.5;

/// The files the arrays of a data set came from, for messages.
pub(crate) struct ArrayNames<'a> {
    pub(crate) positions: &'a Path,
    pub(crate) velocities: &'a Path,
    pub(crate) labels: &'a Path,
    pub(crate) position_errors: &'a Path,
    pub(crate) flow: FlowNames<'a>,
}

impl<'a> ArrayNames<'a> {
    /// All arrays come from one file.
    pub(crate) fn of_one(path: &'a Path) -> Self {
        let flow = FlowNames { field: path, x: path, y: path };
        Self { positions: path, velocities: path, labels: path, position_errors: path, flow }
    }
}

impl DataSet {
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
        self.check_arrays(&ArrayNames {
            positions: Path::new("positions.npy"),
            velocities: Path::new("velocities.npy"),
            labels: Path::new("labels.npy"),
            position_errors: Path::new("position_errors.npy"),
            flow: FlowNames::in_folder(),
        })
    }

    pub(crate) fn check_settings(&self) -> Result<(), SettingFault> {
        self.boundary.check()?;
        positive("frame_interval", self.frame_interval)?;
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

    pub(crate) fn check_arrays(&self, names: &ArrayNames<'_>) -> Result<(), Error> {
        check_shape(names.positions, &self.positions)?;
        check_vectors(names.positions, &self.positions)?;
        check_distinct(names.positions, self)?;
        check_extent(names.positions, self)?;
        check_seen(names.positions, self)?;
        if let Some(found) = self.box_offset.as_ref().map(Vec::len).filter(|found| *found != self.frames()) {
            return Err(Error::Setting(SettingFault::OffsetCount { found, frames: self.frames() }));
        }
        let mismatch = |path: &Path, found: &[usize]| Error::Shape {
            path: path.to_path_buf(),
            fault: ShapeFault::Mismatch { found: found.to_vec(), positions: self.positions.shape().to_vec() },
        };
        if let Some(velocities) = &self.velocities {
            if velocities.dim() != self.positions.dim() {
                return Err(mismatch(names.velocities, velocities.shape()));
            }
            check_vectors(names.velocities, velocities)?;
        }
        if let Some(flow) = &self.flow {
            flow.check(names.flow, self.boundary)?;
            let (found, positions) = (flow.frames(), self.frames());
            if found != positions {
                return Err(grid_error(names.flow.field, GridFault::FrameCount { found, positions }));
            }
        }
        let of_cells = (self.frames(), self.cells());
        if let Some(labels) = self.labels.as_ref().filter(|labels| labels.dim() != of_cells) {
            return Err(mismatch(names.labels, labels.shape()));
        }
        match &self.position_errors {
            Some(errors) if errors.dim() != of_cells => Err(mismatch(names.position_errors, errors.shape())),
            Some(errors) => check_deviations(names.position_errors, errors, &self.positions),
            None => Ok(()),
        }
    }
}

fn check_shape(path: &Path, positions: &Array3<f64>) -> Result<(), Error> {
    let found = || positions.shape().to_vec();
    let (frames, cells, components) = positions.dim();
    let fault = match (frames, cells, components) {
        (0, ..) => ShapeFault::Nothing { found: found(), axis: "frames" },
        (_, 0, _) => ShapeFault::Nothing { found: found(), axis: "cells" },
        (.., 2) => return Ok(()),
        _ => ShapeFault::NotPairs { found: found(), expected: "(frames, cells, 2)" },
    };
    Err(Error::Shape { path: path.to_path_buf(), fault })
}

/// Every vector is finite or absent as a whole.
fn check_vectors(path: &Path, vectors: &Array3<f64>) -> Result<(), Error> {
    for (frame, rows) in vectors.outer_iter().enumerate() {
        for (cell, row) in rows.outer_iter().enumerate() {
            let (x, y) = (row[0], row[1]);
            let fault = if x.is_infinite() || y.is_infinite() {
                ValueFault::Infinite { frame, cell, x, y }
            } else if x.is_nan() != y.is_nan() {
                ValueFault::HalfAbsent { frame, cell, x, y }
            } else {
                continue;
            };
            return Err(value_error(path, fault));
        }
    }
    Ok(())
}

/// Every cell that is present has a standard deviation above zero.
fn check_deviations(path: &Path, errors: &Array2<f64>, positions: &Array3<f64>) -> Result<(), Error> {
    for ((frame, cell), &value) in errors.indexed_iter() {
        let absent = positions[(frame, cell, 0)].is_nan();
        if !(absent || value.is_finite() && value > 0.0) {
            return Err(value_error(path, ValueFault::NoDeviation { frame, cell, value }));
        }
    }
    Ok(())
}

/// No two cells of a frame are at exactly the same place.
fn check_distinct(path: &Path, data: &DataSet) -> Result<(), Error> {
    for (frame, rows) in data.positions.outer_iter().enumerate() {
        if let Some((first, second)) = coincident(rows) {
            let fault =
                ValueFault::Duplicate { frame, first, second, x: rows[[first, 0]], y: rows[[first, 1]] };
            return Err(value_error(path, fault));
        }
    }
    Ok(())
}

fn coincident(rows: ArrayView2<'_, f64>) -> Option<(usize, usize)> {
    // Adding zero makes -0 and 0 the same for total_cmp.
    let mut points: Vec<(f64, f64, usize)> = rows
        .outer_iter()
        .enumerate()
        .filter(|(_, row)| !row[0].is_nan())
        .map(|(cell, row)| (row[0] + 0.0, row[1] + 0.0, cell))
        .collect();
    points.sort_unstable_by(|a, b| {
        let place = a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
        place.then(a.2.cmp(&b.2))
    });
    points
        .windows(2)
        .find(|pair| pair[0].0 == pair[1].0 && pair[0].1 == pair[1].1)
        .map(|pair| (pair[0].2, pair[1].2))
}

/// The cells of the first frame that has any fit into the periodic box, give or take.
fn check_extent(path: &Path, data: &DataSet) -> Result<(), Error> {
    let Boundary::Periodic { lengths } = data.boundary else {
        return Ok(());
    };
    if data.unwrapped {
        return Ok(());
    }
    let first =
        data.positions.outer_iter().enumerate().find(|(_, rows)| rows.iter().any(|value| !value.is_nan()));
    let Some((frame, rows)) = first else {
        return Ok(());
    };
    for (axis, (column, length)) in ['x', 'y'].into_iter().zip(rows.axis_iter(Axis(1)).zip(lengths)) {
        // min and max pass over NaN.
        let smallest = column.fold(f64::INFINITY, |least, &value| least.min(value));
        let largest = column.fold(f64::NEG_INFINITY, |most, &value| most.max(value));
        let extent = largest - smallest;
        if extent > EXTENT_LIMIT * length {
            let fault = ValueFault::BoxTooSmall { frame, axis, extent, length };
            return Err(value_error(path, fault));
        }
    }
    Ok(())
}

/// No cell is outside the field of view.
pub(crate) fn check_seen(path: &Path, data: &DataSet) -> Result<(), Error> {
    let outside = data.field_of_view.as_ref().and_then(|area| area.first_outside(&data.positions));
    match outside {
        Some([frame, cell]) => {
            let [x, y] = [0, 1].map(|axis| data.positions[(frame, cell, axis)]);
            Err(value_error(path, ValueFault::Outside { frame, cell, x, y }))
        }
        None => Ok(()),
    }
}

fn value_error(path: &Path, fault: ValueFault) -> Error {
    Error::Value { path: path.to_path_buf(), fault }
}
