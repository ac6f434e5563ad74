//! What images do not say about themselves.

use crate::dataset::{Boundary, DataSet, YAxis};
use crate::error::Error;
use crate::tracks::describe;
use crate::validate;

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
        validate::positive("pixel_size", pixel).map_err(Error::Setting)?;
        let unit = self.length_unit.as_deref().or(self.pixel_size.is_none().then_some("px"));
        let dataset = describe(boundary, self.frame_interval, self.y_axis, unit, self.time_unit.as_deref());
        dataset.check_settings().map_err(Error::Setting)?;
        Ok((pixel, dataset))
    }
}
