//! The largest difference between two lists of numbers, and where it is.

use super::{Axis, GradientRow, Place, Quantity};
use voronudge_geometry::Vector;

/// A running comparison.
#[derive(Clone, Copy)]
pub(super) struct Comparison {
    /// Magnitude that errors are relative to, beside that of the numbers compared.
    floor: f64,
    /// Largest magnitude of the numbers compared.
    magnitude: f64,
    worst: Option<(f64, Place)>,
    compared: usize,
}

impl Comparison {
    /// Errors are relative to the largest magnitude of the numbers compared.
    pub fn new() -> Self {
        Self::relative_to(0.0)
    }

    /// Errors are relative to `floor` plus the largest magnitude of the numbers expected.
    pub fn relative_to(floor: f64) -> Self {
        Self { floor, magnitude: 0.0, worst: None, compared: 0 }
    }

    pub fn add(&mut self, found: f64, expected: f64, place: impl FnOnce() -> Place) {
        let error = if (found - expected).is_finite() { (found - expected).abs() } else { f64::INFINITY };
        self.magnitude = self.magnitude.max(expected.abs());
        self.compared += 1;
        if self.worst.is_none_or(|(worst, _)| error > worst) {
            self.worst = Some((error, place()));
        }
    }

    pub fn add_vector(&mut self, found: Vector<f64>, expected: Vector<f64>, place: impl Fn(Axis) -> Place) {
        for axis in Axis::BOTH {
            self.add(found[axis.index()], expected[axis.index()], || place(axis));
        }
    }

    /// Both comparisons together; the first place counts among equals.
    pub fn and(self, other: Self) -> Self {
        let worst = match (self.worst, other.worst) {
            (Some(first), Some(second)) if second.0 > first.0 => Some(second),
            (first, second) => first.or(second),
        };
        Self {
            floor: self.floor.max(other.floor),
            magnitude: self.magnitude.max(other.magnitude),
            worst,
            compared: self.compared + other.compared,
        }
    }

    /// A row of the report, if anything was compared.
    pub fn row(self, term: &str, quantity: Quantity) -> Option<GradientRow> {
        let (error, place) = self.worst?;
        let worst = if error == 0.0 { 0.0 } else { error / (self.magnitude + self.floor) };
        let tolerance = quantity.tolerance();
        Some(GradientRow {
            term: term.to_owned(),
            quantity,
            worst,
            place,
            compared: self.compared,
            tolerance,
        })
    }
}
