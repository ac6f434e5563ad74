//! Where cells would have been seen, as a data set declares it.

use ndarray::Array3;
use toml::de::DeValue;
use voronudge_geometry::{Region, Vector};

use crate::boundary::Boundary;
use crate::error::{SettingFault, TomlFault};
use crate::toml_value::{kind, number};
use crate::y_axis::YAxis;

/// The part of the plane where every cell would have been seen, in the unit of length.
#[derive(Debug, Clone, PartialEq)]
pub enum SeenArea {
    /// Two opposite corners `[x0, y0, x1, y1]` of a rectangle along the axes.
    Rectangle([f64; 4]),
    /// The corners of a polygon, one after another.
    Polygon(Vec<[f64; 2]>),
}

impl SeenArea {
    /// An image whose first row begins at y = 0, its size in units of length.
    pub(crate) fn image([width, height]: [f64; 2], y_axis: YAxis) -> Self {
        let mut area = Self::Rectangle([0.0, 0.0, width, height]);
        area.turn(y_axis);
        area
    }

    /// The corners, one after another.
    #[must_use]
    pub fn corners(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Rectangle([x0, y0, x1, y1]) => vec![[*x0, *y0], [*x1, *y0], [*x1, *y1], [*x0, *y1]],
            Self::Polygon(corners) => corners.clone(),
        }
    }

    /// The corners with y as in the files.
    #[must_use]
    pub fn corners_in_file(&self, y_axis: YAxis) -> Vec<[f64; 2]> {
        let mut area = self.clone();
        area.turn(y_axis);
        area.corners()
    }

    /// The same as a region.
    ///
    /// # Errors
    /// Those of [`Region::polygon`].
    pub fn region(&self) -> Result<Region, voronudge_geometry::Error> {
        Region::polygon(self.corners().into_iter().map(Vector::from).collect())
    }

    /// Between y up and y as in the files, in either direction.
    pub(crate) fn turn(&mut self, y_axis: YAxis) {
        if y_axis == YAxis::Up {
            return;
        }
        match self {
            Self::Rectangle([_, y0, _, y1]) => (*y0, *y1) = (-*y0, -*y1),
            Self::Polygon(corners) => corners.iter_mut().for_each(|corner| corner[1] = -corner[1]),
        }
    }

    pub(crate) fn check(&self, boundary: Boundary) -> Result<(), SettingFault> {
        match boundary {
            Boundary::Open => self.region().map(|_| ()).map_err(SettingFault::FieldOfView),
            Boundary::Periodic { .. } => Err(SettingFault::NeedsOpen { key: "field_of_view" }),
        }
    }

    /// The first cell outside, with its frame. A cell on the border is inside.
    pub(crate) fn first_outside(&self, positions: &Array3<f64>) -> Option<[usize; 2]> {
        let region = self.region().ok()?;
        let mut cells = positions.outer_iter().enumerate().flat_map(|(frame, rows)| {
            let places: Vec<Vector<f64>> = rows.outer_iter().map(|row| Vector::new(row[0], row[1])).collect();
            places.into_iter().enumerate().map(move |(cell, r)| ([frame, cell], r))
        });
        cells.find(|(_, r)| r.x.is_finite() && !region.holds(*r)).map(|(place, _)| place)
    }

    /// As in `dataset.toml`.
    pub(crate) fn parse(value: &DeValue<'_>) -> Result<Self, TomlFault> {
        let wrong = |found| TomlFault::WrongType {
            key: "field_of_view",
            found,
            expected: "a rectangle [x0, y0, x1, y1] or the corners [[x, y], [x, y], [x, y], …] of a polygon",
        };
        let numbers = |value: &DeValue<'_>| -> Option<Vec<f64>> {
            let DeValue::Array(items) = value else { return None };
            items.iter().map(|item| number(item.get_ref())).collect()
        };
        let DeValue::Array(items) = value else {
            return Err(wrong(kind(value)));
        };
        let area = match numbers(value) {
            Some(ends) => <[f64; 4]>::try_from(ends).map(Self::Rectangle).ok(),
            None => items
                .iter()
                .map(|item| <[f64; 2]>::try_from(numbers(item.get_ref())?).ok())
                .collect::<Option<_>>()
                .map(Self::Polygon),
        };
        let area = area.ok_or_else(|| wrong("an array of another form"))?;
        area.check(Boundary::Open).map_err(TomlFault::Setting)?;
        Ok(area)
    }

    /// The value of the line in `dataset.toml`.
    pub(crate) fn rendered(&self) -> String {
        let list = |numbers: &[f64]| {
            let texts: Vec<String> = numbers.iter().map(|x| toml::Value::from(*x).to_string()).collect();
            format!("[{}]", texts.join(", "))
        };
        match self {
            Self::Rectangle(ends) => list(ends),
            Self::Polygon(corners) => {
                let corners: Vec<String> = corners.iter().map(|corner| list(corner)).collect();
                format!("[{}]", corners.join(", "))
            }
        }
    }
}
