//! True outlines of cells over the Voronoi polygons of their centroids.

use super::no_data;
use crate::colour::{BLUE, INK, VERMILLION};
use crate::map::Map;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::Units;
use crate::view::{FrameView, Segment};

/// Voronoi polygons (blue, those of cells that are not compared on grey), true outlines (vermillion) and centroids (dots).
#[must_use]
pub fn outline_map(frame: &FrameView, outlines: &[Segment], units: &Units) -> String {
    let title = "outlines and Voronoi polygons";
    let Some(mut map) = Map::new(frame, title) else {
        return no_data(title);
    };
    let [mut used, mut left_out, mut dots, mut truth] = std::array::from_fn(|_| PathData::new());
    for cell in &frame.cells {
        dots.dot(map.view.to_pixel(cell.centre));
        if let Some(polygon) = map.view.polygon(cell) {
            if cell.is_used() { &mut used } else { &mut left_out }.polygon(&polygon);
        }
    }
    for segment in outlines {
        truth.line(&segment.map(|end| map.view.to_pixel(end)));
    }
    let blue = format!(r#"stroke="{BLUE}" stroke-width="1" stroke-linejoin="round""#);
    let red = format!(r#"fill="none" stroke="{VERMILLION}" stroke-width=".8" stroke-linecap="square""#);
    map.layer.path(&left_out, &format!(r##"fill="#ebebeb" {blue}"##));
    map.layer.path(&used, &format!(r#"fill="none" {blue}"#));
    map.layer.path(&truth, &red);
    map.layer.path(&dots, &format!(r#"fill="none" stroke="{INK}" stroke-width="2" stroke-linecap="round""#));
    let mut legend = map.with_legend(44.0);
    legend.scale_bar(units);
    for (x, label, style) in [(176.0, "outline", &red), (262.0, "Voronoi polygon", &blue)] {
        let y = legend.top + 15.0;
        let mut line = PathData::new();
        line.line(&[[x, y], [x + 18.0, y]]);
        legend.svg.path(&line, style);
        legend.svg.text([x + 23.0, y + 4.0], label, TextStyle::label(Anchor::Start));
    }
    legend.left_out(4.0, frame);
    legend.svg.finish()
}
