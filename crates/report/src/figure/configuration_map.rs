//! Cells as they lie and move: polygons coloured by one number, and velocities.

use super::cell_map::{CellScalar, draw_cells};
use super::no_data;
use crate::arrows::{ArrowScale, Arrows, ReferenceMark};
use crate::colour::{ColourScale, INK};
use crate::colour_bar::ColourBar;
use crate::map::{MAP_WIDTH, Map};
use crate::units::Units;
use crate::view::FrameView;

/// Group of the colours of cells and bar.
const PALE: &str = "<g opacity=\".62\">\n";

/// Cells coloured by a number, with their measured velocities as arrows; a scale bar, a colour bar and an arrow of round length
/// state the scales. Without `arrows` nothing moves.
#[must_use]
pub fn configuration_map(
    frame: &FrameView,
    scalar: &CellScalar,
    arrows: Option<&ArrowScale>,
    units: &Units,
) -> String {
    let colours = ColourScale::robust(scalar.values.iter().copied(), scalar.palette);
    let (Some(mut map), Some(colours)) = (Map::new(frame, &scalar.label), colours) else {
        return no_data(&scalar.label);
    };
    // Pale, so that dark arrows are legible on all colours.
    map.layer.raw(PALE);
    draw_cells(&mut map, frame, (scalar, &colours));
    map.layer.raw("</g>\n");
    if let Some(scale) = arrows {
        let mut all = Arrows::default();
        for cell in &frame.cells {
            if let Some(velocity) = cell.measured {
                all.push_on(&map.view, cell.centre, velocity, scale);
            }
        }
        all.draw(&mut map.layer, INK);
    }
    map.boundary(frame);
    let mut legend = map.with_legend(82.0);
    legend.scale_bar(units);
    if let Some(scale) = arrows {
        let unit = units.velocity_text();
        let mark = ReferenceMark { unit: &unit, remark: "", colour: INK };
        legend.reference_arrow(MAP_WIDTH / 2.0, scale, &mark);
    }
    let bar = ColourBar::linear([40.0, MAP_WIDTH - 40.0], legend.top + 36.0, &colours, &scalar.label);
    legend.svg.raw(PALE);
    bar.draw(&mut legend.svg, &colours);
    legend.svg.raw("</g>\n");
    legend.svg.finish()
}
