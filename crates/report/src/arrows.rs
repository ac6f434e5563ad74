//! Arrows that share one scale, and the reference arrow that states it.

use crate::key::LETTER;
use crate::map::{Legend, Viewport};
use crate::numbers::{nice_below, quantile, significant};
use crate::svg::{Anchor, PathData, TextStyle};
use crate::view::{CellView, FrameView, is_finite, length};

/// Nudges of this share of a cell's spacing, and less, are no nudges.
const ROUNDING: f64 = 1e-9;

/// How long a vector is drawn: units of length on the map per unit of the vector.
///
/// Figures that are to be compared get the same scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArrowScale {
    /// Drawn length per unit of the vector.
    pub stretch: f64,
    /// The round magnitude of the reference arrow.
    pub reference: f64,
}

impl ArrowScale {
    /// The scale at which the 95th percentile of the measured (failing those, predicted) speeds is
    /// 1.3 cell spacings long. `None` where no cell moves.
    #[must_use]
    pub fn velocities(frames: &[FrameView]) -> Option<Self> {
        let cells = || frames.iter().flat_map(|frame| &frame.cells);
        let measured = cells().filter_map(|cell| cell.measured).map(length);
        let predicted = cells().filter_map(|cell| cell.predicted).map(length);
        Self::of_speeds(measured, predicted, typical_spacing(frames)?)
    }

    /// The scale at which the 95th percentile of the residual speeds is 1.3 cell spacings long. `None`
    /// where no residual is known.
    #[must_use]
    pub fn residuals(frames: &[FrameView]) -> Option<Self> {
        let cells = frames.iter().flat_map(|frame| &frame.cells);
        let speeds = cells.filter_map(CellView::residual).map(length);
        Self::of_speeds(speeds, std::iter::empty(), typical_spacing(frames)?)
    }

    /// The scale at which the 95th percentile of the `measured` (failing those, `predicted`) speeds
    /// is 1.3 times `spacing` long. `None` where nothing moves.
    #[must_use]
    pub fn of_speeds(
        measured: impl Iterator<Item = f64>,
        predicted: impl Iterator<Item = f64>,
        spacing: f64,
    ) -> Option<Self> {
        let measured = quantile(measured, 0.95).filter(|&speed| speed > 0.0);
        let speed = measured.or_else(|| quantile(predicted, 0.95))?;
        let stretch = 1.3 * spacing / speed;
        stretch.is_finite().then_some(Self { stretch, reference: nice_below(2.0 * speed)? })
    }

    /// The scale at which the 95th percentile of the nudges of used cells is 0.4 to 0.9 cell
    /// spacings long, a round magnification. `None` where no cell is nudged by more than rounding may do.
    #[must_use]
    pub fn nudges(frames: &[FrameView]) -> Option<Self> {
        let cells = frames.iter().flat_map(|frame| &frame.cells).filter(|cell| cell.is_used());
        let size = quantile(cells.map(|cell| length(cell.nudge)), 0.95)?;
        let spacing = typical_spacing(frames)?;
        if size < ROUNDING * spacing {
            return None;
        }
        let most = 0.9 * spacing / size;
        // One digit is round enough for a magnification: 40 rather than 20.
        let power = 10f64.powf(most.log10().floor());
        let stretch = (most / power + 1e-9).floor() * power;
        if !stretch.is_finite() {
            return None;
        }
        Some(Self { stretch, reference: nice_below(2.0 * size)? })
    }
}

/// The heads and shafts of many arrows.
#[derive(Debug, Clone, Default)]
pub struct Arrows {
    shafts: PathData,
    heads: PathData,
}

impl Arrows {
    /// Adds the arrow from `tail` along `drawn`, both in pixels. Vectors that are not finite or
    /// shorter than a third of a pixel are left out.
    pub fn push(&mut self, tail: [f64; 2], drawn: [f64; 2]) {
        let size = length(drawn);
        if !is_finite(tail) || !is_finite(drawn) || size < 0.33 {
            return;
        }
        let head = (0.42 * size).min(5.0);
        let along = drawn.map(|component| component / size * head);
        let tip = [tail[0] + drawn[0], tail[1] + drawn[1]];
        let base = [tip[0] - along[0], tip[1] - along[1]];
        let side = [-along[1] * 0.38, along[0] * 0.38];
        self.shafts.line(&[tail, base]);
        self.heads.polygon(&[
            tip,
            [base[0] + side[0], base[1] + side[1]],
            [base[0] - side[0], base[1] - side[1]],
        ]);
    }

    /// Adds the arrow of `vector` (y up) at `centre`, on a map.
    pub fn push_on(&mut self, view: &Viewport, centre: [f64; 2], vector: [f64; 2], scale: &ArrowScale) {
        let pixels = scale.stretch * view.scale();
        self.push(view.to_pixel(centre), [vector[0] * pixels, -vector[1] * pixels]);
    }

    /// Draws them.
    pub fn draw(&self, svg: &mut crate::svg::Svg, colour: &str) {
        svg.path(
            &self.shafts,
            &format!(r#"fill="none" stroke="{colour}" stroke-width="1.1" stroke-linecap="round""#),
        );
        svg.path(&self.heads, &format!(r#"fill="{colour}""#));
    }
}

impl Legend {
    /// Draws the reference arrow at `x` on the first line, with its magnitude and unit.
    pub fn reference_arrow(&mut self, x: f64, scale: &ArrowScale, mark: &ReferenceMark<'_>) {
        let width = self.svg.size()[0];
        let label = |reference: f64| format!("{} {}{}", significant(reference, 1), mark.unit, mark.remark);
        let pixels = |reference: f64| reference * scale.stretch * self.pixels_per_length();
        let fits = |&reference: &f64| {
            x + pixels(reference) + 7.0 + label(reference).chars().count() as f64 * LETTER < width
        };
        // Long arrows, as of a few large cells, give way to their label.
        let shorter = std::iter::successors(Some(scale.reference), |own| nice_below(0.99 * own));
        let reference = shorter.take(6).find(fits).unwrap_or(scale.reference);
        let (pixels, label) = (pixels(reference), label(reference));
        let y = self.top + 15.0;
        let mut arrows = Arrows::default();
        arrows.push([x, y], [pixels, 0.0]);
        arrows.draw(&mut self.svg, mark.colour);
        self.svg.text([x + pixels + 7.0, y + 4.0], &label, TextStyle::label(Anchor::Start));
    }
}

/// What a reference arrow looks like and says.
#[derive(Debug, Clone, Copy)]
pub struct ReferenceMark<'a> {
    /// Unit behind the number.
    pub unit: &'a str,
    /// Further text behind the unit.
    pub remark: &'a str,
    /// Colour of the arrow.
    pub colour: &'a str,
}

fn typical_spacing(frames: &[FrameView]) -> Option<f64> {
    let stated = quantile(frames.iter().filter_map(FrameView::spacing), 0.5);
    stated.or_else(|| frames.iter().find_map(Viewport::around).map(|view| view.spacing()))
}
