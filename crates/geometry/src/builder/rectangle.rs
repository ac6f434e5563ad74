//! Rectangles: tiles and what is around them.

use crate::Vector;

/// A rectangle `[low, high)`.
#[derive(Clone, Copy)]
pub(super) struct Rectangle {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Rectangle {
    pub fn grown(&self, width: f64) -> Self {
        Self { low: self.low.map(|x| x - width), high: self.high.map(|x| x + width) }
    }

    pub fn contains(&self, r: Vector<f64>) -> bool {
        r.x >= self.low[0] && r.x < self.high[0] && r.y >= self.low[1] && r.y < self.high[1]
    }

    pub fn contains_circle(&self, centre: Vector<f64>, radius: f64) -> bool {
        centre.x - radius >= self.low[0]
            && centre.x + radius < self.high[0]
            && centre.y - radius >= self.low[1]
            && centre.y + radius < self.high[1]
    }
}
