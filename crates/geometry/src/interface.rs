//! The line along which two cells were seen to touch, which images tell and sites are fitted to.

use crate::Vector;

/// The line along which two cells touch, as far as a straight side could follow it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interface {
    /// Indices of the two cells.
    pub cells: [usize; 2],
    /// Length.
    pub length: f64,
    /// Mean of its points.
    pub middle: Vector<f64>,
    /// Along the line; its squared length is the variance of the points along the line less that across it.
    pub extent: Vector<f64>,
}
