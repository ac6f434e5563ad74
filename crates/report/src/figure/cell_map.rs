//! Voronoi polygons coloured by one number per cell.

use super::no_data;
use crate::colour::{ColourScale, Palette};
use crate::map::{HATCH_STYLE, Legend, MAP_WIDTH, Map, Swatch, hatch};
use crate::numbers::{tick_labels, ticks};
use crate::svg::{Anchor, PathData, TextStyle};
use crate::view::{FrameView, Units};

/// Left and right end of the colour bar in pixels.
const BAR: [f64; 2] = [156.0, MAP_WIDTH - 16.0];

/// One number per cell and how to show it.
#[derive(Debug, Clone)]
pub struct CellScalar {
    /// One value per cell, in the order of the frame; not finite where unknown.
    pub values: Vec<f64>,
    /// Label of the colour bar, with its unit.
    pub label: String,
    /// Colours.
    pub palette: Palette,
    /// Limits of the colour bar; the 2nd and 98th percentile of the used cells if not given.
    pub limits: Option<[f64; 2]>,
}

impl CellScalar {
    /// Area over the mean area of the used cells.
    #[must_use]
    pub fn area_ratio(frame: &FrameView) -> Self {
        let mean = frame.mean_area();
        Self {
            values: frame.cells.iter().map(|cell| cell.area / mean).collect(),
            label: "area / mean area".to_owned(),
            palette: Palette::Sequential,
            limits: None,
        }
    }

    /// Shape index P/√A: 3.72 for a regular hexagon, larger for elongated cells.
    #[must_use]
    pub fn shape_index(frame: &FrameView) -> Self {
        Self {
            values: frame.cells.iter().map(|cell| cell.shape_index()).collect(),
            label: "shape index P/√A".to_owned(),
            palette: Palette::Sequential,
            limits: None,
        }
    }
}

/// A map of the cells coloured by `scalar`, with scale bar and colour bar. Cells left out are
/// hatched; cells without a value stay white. Triangles at the ends of the colour bar say that some
/// values lie beyond it.
#[must_use]
pub fn cell_map(frame: &FrameView, scalar: &CellScalar, units: &Units) -> String {
    let used = frame.cells.iter().zip(&scalar.values).filter(|(cell, _)| cell.is_used());
    let colours = ColourScale::robust(used.map(|(_, &value)| value), scalar.palette);
    let (Some(mut map), Some(colours)) = (Map::new(frame, &scalar.label), colours) else {
        return no_data(&scalar.label);
    };
    let colours = scalar.limits.map_or(colours, |limits| colours.with_limits(limits));
    draw_cells(&mut map, frame, (scalar, &colours));
    map.boundary(frame);
    let mut legend = map.with_legend(54.0);
    legend.scale_bar(units);
    legend.left_out(4.0, frame, Swatch::Hatched);
    colour_bar(&mut legend, &colours, &scalar.label);
    legend.svg.finish()
}

fn draw_cells(map: &mut Map, frame: &FrameView, (scalar, colours): (&CellScalar, &ColourScale)) {
    let mut classes = vec![PathData::new(); ColourScale::LEVELS];
    let [mut hatching, mut outlines] = [PathData::new(), PathData::new()];
    for (cell, &value) in frame.cells.iter().zip(&scalar.values) {
        let Some(polygon) = map.view.polygon(cell) else {
            continue;
        };
        match colours.level(value).filter(|_| cell.is_used()) {
            Some(level) => classes[level].polygon(&polygon),
            None => {
                outlines.polygon(&polygon);
                if !cell.is_used() {
                    hatch(&mut hatching, &polygon);
                }
            }
        }
    }
    map.layer.path(&hatching, HATCH_STYLE);
    map.layer.path(&outlines, r##"fill="none" stroke="#b5b5b5" stroke-width=".6""##);
    for (level, path) in classes.iter().enumerate() {
        let fill = colours.colour(level);
        map.layer.path(
            path,
            &format!(r##"fill="{fill}" stroke="#fff" stroke-width=".7" stroke-linejoin="round""##),
        );
    }
}

fn colour_bar(legend: &mut Legend, colours: &ColourScale, label: &str) {
    let [left, right] = BAR;
    let [top, bottom] = [legend.top + 9.0, legend.top + 20.0];
    let width = (right - left) / ColourScale::LEVELS as f64;
    for level in 0..ColourScale::LEVELS {
        let x = left + level as f64 * width;
        let mut cell = PathData::new();
        // Half a pixel of overlap hides the seams between the classes.
        cell.rectangle([x, top], [(x + width + 0.5).min(right), bottom]);
        legend.svg.path(&cell, &format!(r#"fill="{}""#, colours.colour(level)));
    }
    let middle = (top + bottom) / 2.0;
    let [below, above] = colours.extended();
    for (is_extended, x, tip, level) in
        [(below, left, left - 9.0, 0), (above, right, right + 9.0, ColourScale::LEVELS - 1)]
    {
        if is_extended {
            let mut triangle = PathData::new();
            triangle.polygon(&[[x, top], [tip, middle], [x, bottom]]);
            legend.svg.path(&triangle, &format!(r#"fill="{}""#, colours.colour(level)));
        }
    }
    let [low, high] = colours.limits();
    let positions = ticks([low, high], 5);
    for (&position, text) in positions.iter().zip(tick_labels(&positions)) {
        let x = left + (position - low) / (high - low) * (right - left);
        let mut tick = PathData::new();
        tick.line(&[[x, bottom], [x, bottom + 3.5]]);
        legend.svg.path(&tick, r##"fill="none" stroke="#222" stroke-width=".8""##);
        legend.svg.text([x, bottom + 14.5], &text, TextStyle::label(Anchor::Middle));
    }
    let at = [(left + right) / 2.0, bottom + 29.0];
    legend.svg.text(at, label, TextStyle::label(Anchor::Middle));
}
