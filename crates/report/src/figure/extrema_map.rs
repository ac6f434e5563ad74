//! A field with the cells found in it.

use super::no_data;
use crate::colour::{ColourScale, Palette, VERMILLION};
use crate::colour_bar::ColourBar;
use crate::map::{MAP_WIDTH, Map};
use crate::svg::PathData;
use crate::units::Units;
use crate::view::FrameView;

/// The most squares along an axis that a field is drawn with.
const MOST_SQUARES: usize = 200;

/// A field on pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtremaMap<'a> {
    /// Values, row after row.
    pub values: &'a [f64],
    /// Columns and rows.
    pub size: [usize; 2],
    /// Place of the corner where the first pixel of the first row begins.
    pub corner: [f64; 2],
    /// Steps to the next column and to the next row.
    pub step: [f64; 2],
}

/// The field in colours, averaged over squares if there are very many pixels, with the Voronoi polygons (white) of the cells found in it
/// (vermillion dots).
#[must_use]
pub fn extrema_map(frame: &FrameView, field: &ExtremaMap<'_>, units: &Units) -> String {
    let title = "the field and its cells";
    let colours = ColourScale::robust(field.values.iter().copied(), Palette::Sequential);
    let (Some(mut map), Some(colours)) = (Map::new(frame, title), colours) else {
        return no_data(title);
    };
    let [columns, rows] = field.size;
    let square = columns.max(rows).div_ceil(MOST_SQUARES).max(1);
    let mut classes = vec![PathData::new(); ColourScale::LEVELS];
    for top in (0..rows).step_by(square) {
        for left in (0..columns).step_by(square) {
            let (bottom, right) = ((top + square).min(rows), (left + square).min(columns));
            let pixels =
                || (top..bottom).flat_map(|row| (left..right).map(move |column| row * columns + column));
            let mean = pixels().map(|k| field.values[k]).sum::<f64>() / pixels().count() as f64;
            let place = |column: usize, row: usize| {
                map.view.to_pixel([
                    field.corner[0] + column as f64 * field.step[0],
                    field.corner[1] + row as f64 * field.step[1],
                ])
            };
            if let Some(level) = colours.level(mean) {
                classes[level].rectangle(place(left, top), place(right, bottom));
            }
        }
    }
    for (level, path) in classes.iter().enumerate() {
        let colour = colours.colour(level);
        map.layer.path(path, &format!(r#"fill="{colour}" stroke="{colour}" stroke-width=".5""#));
    }
    let [mut polygons, mut dots] = [PathData::new(), PathData::new()];
    for cell in &frame.cells {
        dots.dot(map.view.to_pixel(cell.centre));
        if let Some(polygon) = map.view.polygon(cell) {
            polygons.polygon(&polygon);
        }
    }
    map.layer.path(&polygons, r##"fill="none" stroke="#fff" stroke-width=".9" stroke-linejoin="round""##);
    let dot = format!(r#"fill="none" stroke="{VERMILLION}" stroke-width="5" stroke-linecap="round""#);
    map.layer.path(&dots, &dot);
    map.boundary(frame);
    let mut legend = map.with_legend(54.0);
    legend.scale_bar(units);
    let bar = ColourBar::linear([156.0, MAP_WIDTH - 16.0], legend.top + 9.0, &colours, "field");
    bar.draw(&mut legend.svg, &colours);
    legend.svg.finish()
}
