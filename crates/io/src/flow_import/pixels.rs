//! Dense displacements, one for each pixel, averaged over squares.

use std::path::Path;

use ndarray::{Array4, ArrayView3, Axis};

use crate::error::{Error, GridFault};
use crate::flow::grid_error;

/// The squares along one axis.
pub(super) struct Squares {
    /// First pixel of each square, then the pixel behind the last square.
    edges: Vec<usize>,
    /// Side in units of length.
    side: f64,
}

impl Squares {
    /// Whole squares of the side `side`, from the edge of the first pixel on.
    ///
    /// A pixel p takes up [p, p + 1) · `pixel` and belongs to the square its centre is in.
    pub(super) fn cover(
        path: &Path,
        axis: char,
        pixels: usize,
        pixel: f64,
        side: f64,
    ) -> Result<Self, Error> {
        let ratio = side / pixel;
        // 16.25 / 0.65 means 25, although it is not exactly that.
        let whole = (ratio - ratio.round()).abs() <= 1e-9 * ratio;
        let ratio = if whole { ratio.round() } else { ratio };
        if ratio < 1.0 {
            return Err(grid_error(path, GridFault::FinerThanPixels { spacing: side, pixel }));
        }
        let count = (pixels as f64 / ratio).floor() as usize;
        if count < 2 {
            return Err(grid_error(path, GridFault::TooCoarse { axis, pixels, pixel, spacing: side }));
        }
        let edges = (0..=count).map(|square| (square as f64 * ratio - 0.5).ceil().max(0.0) as usize);
        Ok(Self { edges: edges.map(|edge| edge.min(pixels)).collect(), side })
    }

    pub(super) fn count(&self) -> usize {
        self.edges.len() - 1
    }

    /// Centres of the squares in units of length.
    pub(super) fn centres(&self) -> Vec<f64> {
        (0..self.count()).map(|square| (square as f64 + 0.5) * self.side).collect()
    }
}

/// Means over squares, (frames, rows, columns, 2), of displacements (frames, ny, nx, 2).
///
/// NaN where fewer than half of the pixels of a square have a displacement.
pub(super) fn average(dense: &Array4<f64>, rows: &Squares, columns: &Squares) -> Array4<f64> {
    let frames = dense.dim().0;
    let mut means = Array4::from_elem((frames, rows.count(), columns.count(), 2), f64::NAN);
    for (frame, mut means) in dense.outer_iter().zip(means.outer_iter_mut()) {
        for (top, mut means) in rows.edges.windows(2).zip(means.outer_iter_mut()) {
            let band = frame.slice_axis(Axis(0), (top[0]..top[1]).into());
            for (left, mut mean) in columns.edges.windows(2).zip(means.outer_iter_mut()) {
                let square = band.slice_axis(Axis(1), (left[0]..left[1]).into());
                if let Some([x, y]) = mean_of(square) {
                    (mean[0], mean[1]) = (x, y);
                }
            }
        }
    }
    means
}

fn mean_of(square: ArrayView3<'_, f64>) -> Option<[f64; 2]> {
    let (mut sum, mut count) = ([0.0; 2], 0_usize);
    for pixel in square.lanes(Axis(2)) {
        if !pixel[0].is_nan() {
            sum = [sum[0] + pixel[0], sum[1] + pixel[1]];
            count += 1;
        }
    }
    let pixels = square.len() / 2;
    (2 * count >= pixels).then(|| sum.map(|sum| sum / count as f64))
}
