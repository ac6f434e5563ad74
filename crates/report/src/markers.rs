//! Marks of points that differ in shape, not in colour alone.

use crate::svg::PathData;

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A circle.
    Circle,
    /// An upright square.
    Square,
    /// A triangle on its base.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// Two crossing diagonals, to be stroked.
    Cross,
}

impl Marker {
    /// Adds the mark at a place in pixels; circles have the radius `size`, the others a like area.
    pub fn push(self, path: &mut PathData, [x, y]: [f64; 2], size: f64) {
        let ring = |corners: usize, turn: f64, reach: f64| -> Vec<[f64; 2]> {
            let angle = |corner: usize| (corner as f64 / corners as f64 + turn) * std::f64::consts::TAU;
            let corner = |corner: usize| [angle(corner).cos(), angle(corner).sin()];
            (0..corners).map(corner).map(|at| [x + reach * at[0], y + reach * at[1]]).collect()
        };
        match self {
            Self::Circle => path.polygon(&ring(20, 0.0, size)),
            Self::Square => path.polygon(&ring(4, 0.125, 1.25 * size)),
            Self::Triangle => path.polygon(&ring(3, 0.75, 1.45 * size)),
            Self::Diamond => path.polygon(&ring(4, 0.0, 1.3 * size)),
            Self::Cross => {
                path.line(&[[x - size, y - size], [x + size, y + size]]);
                path.line(&[[x - size, y + size], [x + size, y - size]]);
            }
        }
    }
}
