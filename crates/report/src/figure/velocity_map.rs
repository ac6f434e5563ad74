//! Measured, predicted and residual velocities as arrows on one scale.

use super::no_data;
use crate::arrows::{ArrowScale, Arrows, ReferenceMark};
use crate::colour::{BLUE, GREEN, INK, VERMILLION};
use crate::map::{Legend, Map};
use crate::units::Units;
use crate::view::{CellView, FrameView, residual};

/// Which velocities a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VelocityField {
    /// As measured.
    Measured,
    /// As the fitted model gives them.
    Predicted,
    /// Measured minus predicted.
    Residual,
}

impl VelocityField {
    /// All of them, in the order of a figure's panels.
    pub const ALL: [Self; 3] = [Self::Measured, Self::Predicted, Self::Residual];

    /// Caption of the panel.
    #[must_use]
    pub fn caption(self) -> &'static str {
        match self {
            Self::Measured => "measured velocities",
            Self::Predicted => "predicted velocities",
            Self::Residual => "residual (measured − predicted)",
        }
    }

    pub(super) fn colour(self) -> &'static str {
        match self {
            Self::Measured => INK,
            Self::Predicted => BLUE,
            Self::Residual => VERMILLION,
        }
    }

    /// This field, given the other two where they are known.
    pub(super) fn select(self, measured: Option<[f64; 2]>, predicted: Option<[f64; 2]>) -> Option<[f64; 2]> {
        match self {
            Self::Measured => measured,
            Self::Predicted => predicted,
            Self::Residual => residual(measured?, predicted?),
        }
    }

    fn of(self, cell: &CellView) -> Option<[f64; 2]> {
        self.select(cell.measured, cell.predicted)
    }
}

/// Arrows of one velocity field over faint cell outlines. Give all panels the same `scale`
/// ([`ArrowScale::velocities`]); cells without that velocity have no arrow.
#[must_use]
pub fn velocity_map(
    frame: &FrameView,
    field: VelocityField,
    scale: Option<&ArrowScale>,
    units: &Units,
) -> String {
    match (Map::new(frame, field.caption()), scale) {
        (Some(map), Some(scale)) => draw_velocities(map, frame, (field, scale), units),
        _ => no_data(field.caption()),
    }
}

/// Arrows of the polarities over faint cell outlines, on the scale of the velocities.
#[must_use]
pub fn polarity_map(frame: &FrameView, scale: Option<&ArrowScale>, units: &Units) -> String {
    const CAPTION: &str = "polarities";
    match (Map::new(frame, CAPTION), scale) {
        (Some(map), Some(scale)) => draw(map, frame, CAPTION, (|cell| cell.polarity, GREEN), scale, units),
        _ => no_data(CAPTION),
    }
}

/// Draws the arrows of one field on an empty map, and its legend.
pub(super) fn draw_velocities(
    map: Map,
    frame: &FrameView,
    (field, scale): (VelocityField, &ArrowScale),
    units: &Units,
) -> String {
    draw(map, frame, field.caption(), (|cell| field.of(cell), field.colour()), scale, units)
}

/// Draws arrows of a colour on an empty map, and its legend.
fn draw(
    mut map: Map,
    frame: &FrameView,
    caption: &str,
    (of, colour): (impl Fn(&CellView) -> Option<[f64; 2]>, &str),
    scale: &ArrowScale,
    units: &Units,
) -> String {
    if frame.cells.iter().all(|cell| of(cell).is_none()) {
        return no_data(caption);
    }
    map.outlines(frame);
    let mut arrows = Arrows::default();
    for cell in &frame.cells {
        if let Some(velocity) = of(cell) {
            arrows.push_on(&map.view, cell.centre, velocity, scale);
        }
    }
    arrows.draw(&mut map.layer, colour);
    arrow_legend(map, frame, (colour, scale), units).svg.finish()
}

/// Scale bar, reference arrow and the entry for cells left out, beneath a map of arrows of a colour.
pub(super) fn arrow_legend(
    map: Map,
    frame: &FrameView,
    (colour, scale): (&str, &ArrowScale),
    units: &Units,
) -> Legend {
    let mut legend = map.with_legend(48.0);
    legend.scale_bar(units);
    let unit = units.velocity_text();
    let mark = ReferenceMark { unit: &unit, remark: "", colour };
    legend.reference_arrow(160.0, scale, &mark);
    legend.left_out(4.0, frame);
    legend
}
