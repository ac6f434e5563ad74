//! The largest upright rectangle in which every cell would have been seen in all frames.

use crate::{Frame, Recording};
use voronudge_geometry::{Domain, Vector};

/// Places along each axis at which it is asked whether they are in the regions.
const RASTER: usize = 48;

/// A rectangle, or a whole periodic box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
    /// Lower left corner.
    pub corner: Vector<f64>,
    /// Width and height.
    pub lengths: [f64; 2],
}

impl Window {
    /// Of a recording in the open plane, beside the stage; `None` if the regions have nothing in common.
    pub fn of(recording: &Recording) -> Option<Self> {
        let first = recording.frames().first()?;
        let (lower, upper) = extent(first)?;
        let step = (upper - lower) / RASTER as f64;
        let centre = |column: usize, row: usize| {
            lower + Vector::new((column as f64 + 0.5) * step.x, (row as f64 + 0.5) * step.y)
        };
        let held = |column: usize, row: usize| {
            let r = centre(column, row);
            recording.frames().iter().all(|frame| match &frame.region {
                Some(region) => region.contains(r + frame.stage),
                None => true,
            })
        };
        let [first_column, first_row, columns, rows] = largest(held)?;
        let corner = lower + Vector::new(first_column as f64 * step.x, first_row as f64 * step.y);
        Some(Self { corner, lengths: [columns as f64 * step.x, rows as f64 * step.y] })
    }

    pub fn area(&self) -> f64 {
        self.lengths[0] * self.lengths[1]
    }

    /// Where a place is in the window, as shares of its width and height; `None` outside.
    pub fn share(&self, r: Vector<f64>) -> Option<[f64; 2]> {
        let d = r - self.corner;
        let share = [d.x / self.lengths[0], d.y / self.lengths[1]];
        share.iter().all(|share| (0.0..1.0).contains(share)).then_some(share)
    }
}

/// Corners of the smallest upright rectangle that holds the cells that count.
fn extent(frame: &Frame) -> Option<(Vector<f64>, Vector<f64>)> {
    if matches!(frame.tessellation.domain(), Domain::Periodic(_)) {
        return None;
    }
    let mut all = frame.in_view().map(|cell| frame.positions[cell] - frame.stage);
    let first = all.next()?;
    let (lower, upper) = all.fold((first, first), |(lower, upper), r| (lower.inf(&r), upper.sup(&r)));
    (upper.x > lower.x && upper.y > lower.y).then_some((lower, upper))
}

/// The largest rectangle of a raster whose places are all held: first column and row, and how many of each.
fn largest(held: impl Fn(usize, usize) -> bool) -> Option<[usize; 4]> {
    let mut heights = [0usize; RASTER];
    let mut best: Option<([usize; 4], usize)> = None;
    for row in 0..RASTER {
        for (column, height) in heights.iter_mut().enumerate() {
            *height = if held(column, row) { *height + 1 } else { 0 };
        }
        for first in 0..RASTER {
            let mut height = usize::MAX;
            for (more, own) in heights[first..].iter().enumerate() {
                height = height.min(*own);
                let area = height * (more + 1);
                if area > best.map_or(0, |(_, area)| area) {
                    best = Some(([first, row + 1 - height, more + 1, height], area));
                }
            }
        }
    }
    best.map(|(rectangle, _)| rectangle)
}
