//! Figures of cells that differ.

use super::Figure;
use crate::colour::Palette;
use crate::figure::{CellScalar, cell_map, distribution};
use crate::many_cells::Squares;
use crate::units::Units;
use crate::view::FrameView;

/// Deviations of cells in one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct SpreadView {
    /// Symbol of the parameter.
    pub symbol: String,
    /// Deviation of each cell of each frame drawn, relative to the mean; NaN where there is none.
    pub drawn: Vec<Vec<f64>>,
}

impl SpreadView {
    fn label(&self) -> String {
        format!("{} of the cell / mean − 1", self.symbol)
    }

    /// A map of one of the frames drawn.
    pub(super) fn drawn_on(
        &self,
        (frame, squares): (&FrameView, &Squares),
        index: usize,
        units: &Units,
    ) -> Figure {
        let caption = format!("deviations of {}, shrunk towards the mean", self.symbol);
        Figure::new(cell_map(frame, &squares.means(self.map(index)), units), &squares.caption(&caption))
    }

    fn map(&self, index: usize) -> CellScalar {
        CellScalar {
            values: self.drawn.get(index).cloned().unwrap_or_default(),
            label: self.label(),
            palette: Palette::Diverging { centre: 0.0 },
            limits: None,
        }
    }

    /// How cells are distributed.
    pub(super) fn histogram(&self) -> Figure {
        let values: Vec<f64> = self.drawn.iter().flatten().copied().filter(|own| own.is_finite()).collect();
        let title = format!("cells differ in {}", self.symbol);
        Figure::new(
            distribution(&title, &self.label(), &values, None),
            "What is expected of each cell of the frames drawn, given the data. Estimates are shrunk towards the mean: they spread \
             less than the cells do, the less the data say of each.",
        )
    }
}
