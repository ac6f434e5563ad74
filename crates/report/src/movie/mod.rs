//! Cells that move, coloured by one number at a time: what the player of a page shows, and an animated image.
//!
//! ```
//! use voronudge_report::movie::chosen;
//! assert_eq!(chosen(5, 100), [0, 1, 2, 3, 4]);
//! // Of many frames some are shown, evenly spaced, the last among them.
//! let of_many = chosen(1000, 100);
//! assert_eq!((of_many.len(), of_many.last()), (200, Some(&999)));
//! ```

mod encoding;
mod image;
mod lettering;
mod quantity;

pub use encoding::UNKNOWN;
pub use quantity::{ArrowField, Colouring, Quantity};

use crate::figure::{CellScalar, cell_map, no_data};
pub use crate::many_cells::MOST_IN_FRAME;
use crate::many_cells::keep_middle;
use crate::map::Viewport;
use crate::units::Units;
use crate::view::FrameView;

/// Frames of a movie at most.
pub const MOST_FRAMES: usize = 200;
/// Cells in all frames together at most; each takes up to 90 bytes of the page.
pub const MOST_IN_ALL: usize = 40_000;

/// Which of `frames` frames of some `cells` cells a movie shows: evenly spaced ones up to the last.
#[must_use]
pub fn chosen(frames: usize, cells: usize) -> Vec<usize> {
    let most = (MOST_IN_ALL / cells.clamp(1, MOST_IN_FRAME)).min(MOST_FRAMES);
    let stride = frames.div_ceil(most).max(1);
    let mut frames: Vec<usize> = (0..frames).rev().step_by(stride).collect();
    frames.reverse();
    frames
}

/// Cells of some frames, with what they can be coloured by and which arrows they can have.
#[derive(Debug, Clone)]
pub struct CellMovie {
    frames: Vec<FrameView>,
    view: Viewport,
    quantities: Vec<Quantity>,
    arrows: Vec<ArrowField>,
    units: Units,
    thinned: Thinned,
}

/// What a movie leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Thinned {
    /// Frames that there are.
    frames: usize,
    /// Most cells of a frame.
    cells: usize,
}

impl CellMovie {
    /// A movie of `frames`, which were [`chosen`] of `of` frames; `None` if there are no cells.
    ///
    /// Cells can be coloured by area, shape, neighbours, speed, vorticity and residual, as far as these are known.
    #[must_use]
    pub fn new(mut frames: Vec<FrameView>, of: usize, units: &Units) -> Option<Self> {
        let cells = frames.iter().map(|frame| frame.cells.len()).max()?;
        keep_middle(&mut frames, cells);
        let view = Viewport::around_all(&frames)?;
        let (quantities, arrows) =
            (Quantity::of_frames(&frames, units), ArrowField::of_frames(&frames, units));
        let thinned = Thinned { frames: of.max(frames.len()), cells };
        Some(Self { frames, view, quantities, arrows, units: units.clone(), thinned })
    }

    /// Also the residuals of another fit to the same frames; `names` are those of the residuals so far and of these.
    #[must_use]
    pub fn with_residuals(mut self, [so_far, name]: [&str; 2], mut frames: Vec<FrameView>) -> Self {
        keep_middle(&mut frames, self.thinned.cells);
        let same = |(own, other): (&FrameView, &FrameView)| own.cells.len() == other.cells.len();
        if frames.len() != self.frames.len() || !self.frames.iter().zip(&frames).all(same) {
            return self;
        }
        let own = self.quantities.iter().position(|own| own.colouring == Colouring::Residual);
        if let (Some(index), Some(mut other)) = (own, Quantity::residual(name, &frames, &self.units)) {
            // The same colours for the same residual.
            other.colours = self.quantities[index].colours;
            so_far.clone_into(&mut self.quantities[index].name);
            self.quantities.insert(index + 1, other);
        }
        let own = self.arrows.iter().position(ArrowField::is_residual);
        let scale = own.map(|index| self.arrows[index].scale());
        let other = ArrowField::residual(name, &frames, &self.units, scale);
        own.into_iter().for_each(|index| so_far.clone_into(&mut self.arrows[index].name));
        self.arrows.extend(other);
        self
    }

    /// The frames that are shown.
    #[must_use]
    pub fn frames(&self) -> &[FrameView] {
        &self.frames
    }

    /// What cells can be coloured by.
    #[must_use]
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// Which arrows cells can have.
    #[must_use]
    pub fn arrows(&self) -> &[ArrowField] {
        &self.arrows
    }

    /// The last frame in which the first quantity is known of a cell that is used.
    fn first_shown(&self) -> usize {
        let is_known = |(frame, values): (&FrameView, &Vec<f64>)| {
            frame.cells.iter().zip(values).any(|(cell, value)| cell.is_used() && value.is_finite())
        };
        let of_first = self.quantities.first().map_or(&[][..], |own| &own.values);
        self.frames.iter().zip(of_first).rposition(is_known).unwrap_or(self.frames.len().saturating_sub(1))
    }

    /// That frame as a picture that does not move, coloured by the first quantity.
    #[must_use]
    pub fn still(&self) -> String {
        let Some(quantity) = self.quantities.first() else { return no_data("cells") };
        let index = self.first_shown();
        let (Some(frame), Some(values)) = (self.frames.get(index), quantity.values.get(index)) else {
            return no_data("cells");
        };
        let scalar = CellScalar {
            values: values.clone(),
            label: quantity.label(),
            palette: quantity.colouring.palette(),
            limits: Some(quantity.colours.limits()),
        };
        cell_map(frame, &scalar, &self.units)
    }

    /// What is left out, in a sentence; empty if nothing is.
    #[must_use]
    pub fn what_is_left_out(&self) -> String {
        let mut parts = Vec::new();
        if self.thinned.frames > self.frames.len() {
            parts.push(format!("{} of {} frames", self.frames.len(), self.thinned.frames));
        }
        if self.thinned.cells > MOST_IN_FRAME {
            parts.push(format!("about {MOST_IN_FRAME} of {} cells, in the middle", self.thinned.cells));
        }
        if parts.is_empty() { String::new() } else { format!("Shown are {}.", parts.join(" and ")) }
    }
}
