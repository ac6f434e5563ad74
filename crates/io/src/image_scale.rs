//! What images do not say about themselves.

use ndarray::Array3;

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::Error;
use crate::positive::positive;
use crate::y_axis::YAxis;

/// Units and directions of an image. The default leaves everything open.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImageScale {
    /// Length of a pixel; default 1.
    pub pixel_size: Option<f64>,
    /// Name of the unit of length after scaling; default `px` without a pixel size, else `length`.
    pub length_unit: Option<String>,
    /// Name of the unit of time; default `frame` where no interval is given, else `time`.
    pub time_unit: Option<String>,
    /// Time between frames; default 1.
    pub frame_interval: Option<f64>,
    /// The direction in which rows are counted; default down.
    pub y_axis: Option<YAxis>,
}

impl ImageScale {
    /// The size of a pixel, and a data set that is empty so far.
    pub(crate) fn begin(&self, boundary: Boundary) -> Result<(f64, DataSet), Error> {
        let pixel = self.pixel_size.unwrap_or(1.0);
        positive("pixel_size", pixel).map_err(Error::Setting)?;
        let unit = self.length_unit.as_deref().or(self.pixel_size.is_none().then_some("px"));
        let dataset = describe(boundary, self.frame_interval, self.y_axis, unit, self.time_unit.as_deref());
        dataset.check_settings().map_err(Error::Setting)?;
        Ok((pixel, dataset))
    }
}

/// The data set as far as the options know it.
pub(crate) fn describe(
    boundary: Boundary,
    frame_interval: Option<f64>,
    y_axis: Option<YAxis>,
    length_unit: Option<&str>,
    time_unit: Option<&str>,
) -> DataSet {
    let default_time = match frame_interval {
        Some(_) => "time",
        None => "frame",
    };
    DataSet {
        frame_interval: frame_interval.unwrap_or(1.0),
        length_unit: length_unit.unwrap_or("length").to_owned(),
        time_unit: time_unit.unwrap_or(default_time).to_owned(),
        y_axis: y_axis.unwrap_or(YAxis::Down),
        ..DataSet::new(Array3::zeros((0, 0, 2)), boundary)
    }
}
