//! Voronoi polygons coloured by one number per cell.

use super::no_data;
use crate::colour::{ColourScale, Palette};
use crate::colour_bar::ColourBar;
use crate::map::{GREY, HATCH_STYLE, Legend, MAP_WIDTH, Map, hatch};
use crate::svg::PathData;
use crate::units::Units;
use crate::view::{CellStatus, FrameView};

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
/// grey, uncertain ones hatched; cells without a value stay white. Triangles at the ends of the colour bar say that some
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
    map.not_detected(frame);
    map.boundary(frame);
    let mut legend = map.with_legend(54.0);
    legend.scale_bar(units);
    legend.left_out(4.0, frame);
    colour_bar(&mut legend, &colours, &scalar.label);
    legend.svg.finish()
}

pub(super) fn draw_cells(map: &mut Map, frame: &FrameView, (scalar, colours): (&CellScalar, &ColourScale)) {
    let mut classes = vec![PathData::new(); ColourScale::LEVELS];
    let [mut hatching, mut outlines, mut left_out] = std::array::from_fn(|_| PathData::new());
    for (cell, &value) in frame.cells.iter().zip(&scalar.values) {
        let Some(polygon) = map.view.polygon(cell) else {
            continue;
        };
        match colours.level(value).filter(|_| cell.is_used()) {
            Some(level) => classes[level].polygon(&polygon),
            None if cell.is_used() => outlines.polygon(&polygon),
            None => {
                if cell.status == CellStatus::NotDetected { &mut outlines } else { &mut left_out }
                    .polygon(&polygon);
                if cell.status == CellStatus::Uncertain {
                    hatch(&mut hatching, &polygon);
                }
            }
        }
    }
    let stroke = r##"stroke="#b5b5b5" stroke-width=".6""##;
    map.layer.path(&left_out, &format!(r#"fill="{GREY}" {stroke}"#));
    map.layer.path(&hatching, HATCH_STYLE);
    map.layer.path(&outlines, &format!(r#"fill="none" {stroke}"#));
    for (level, path) in classes.iter().enumerate() {
        let fill = colours.colour(level);
        map.layer.path(
            path,
            &format!(r##"fill="{fill}" stroke="#fff" stroke-width=".7" stroke-linejoin="round""##),
        );
    }
}

fn colour_bar(legend: &mut Legend, colours: &ColourScale, label: &str) {
    ColourBar::linear(BAR, legend.top + 9.0, colours, label).draw(&mut legend.svg, colours);
}
